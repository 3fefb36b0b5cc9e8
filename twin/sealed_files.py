"""Files that say what they hold: each has the key of its content, and a hash of all that; a damaged one is not read."""

import hashlib
import os
import pickle
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

SEAL = hashlib.sha256().digest_size  # bytes


class Files:
    """The files of one subject: `load`, `save` and `flush`, as numba's cache calls them."""

    def __init__(self, folder: Path, name: str, stamp: Any, dumps: Callable[[Any], bytes] = pickle.dumps) -> None:
        self.folder = folder
        self.name = name
        self.stamp = stamp
        self._dumps = dumps

    def load(self, key: Any) -> Any:
        """What was saved under a key; None when there is nothing, or nothing whole."""
        try:
            content = self._path(key).read_bytes()
            if hashlib.sha256(content[:-SEAL]).digest() != content[-SEAL:]:
                return None
            found, data = pickle.loads(content[:-SEAL])
        except (OSError, pickle.UnpicklingError):
            return None
        return data if found == (self.stamp, key) else None

    def save(self, key: Any, data: Any) -> None:
        """Keep data under a key. Raises OSError and leaves nothing behind where that cannot be."""
        content = self._dumps(((self.stamp, key), data))
        path = self._path(key)
        draft = path.with_name(f"{path.name}.{os.getpid()}")
        try:
            draft.write_bytes(content + hashlib.sha256(content).digest())
            draft.replace(path)
        except OSError:
            with suppress(OSError):
                draft.unlink()
            raise

    def flush(self) -> None:
        """Forget all that was saved."""
        for path in self.folder.glob(f"{self.name}.*.nbc"):
            path.unlink(missing_ok=True)

    def _path(self, key: Any) -> Path:
        return self.folder / f"{self.name}.{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}.nbc"
