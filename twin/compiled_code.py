"""Compiled functions on disk: one sealed file for each function and signature, written in one piece.

numba's own cache keeps an index beside its data: an index that a power cut has emptied ends every later start, and two
processes that compile at one time can mix their entries up. A file here holds the key of what it holds, and a hash of
all that; one that is damaged is compiled anew. What cannot be written stays in memory.
"""

import hashlib
import os
import pickle
from contextlib import suppress
from pathlib import Path
from typing import Any, ClassVar

from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator
from numba.core.serialize import dumps

SEAL = hashlib.sha256().digest_size  # bytes


class Files:
    """The files of one function: `load`, `save` and `flush`, as numba's cache calls them."""

    def __init__(self, folder: Path, name: str, stamp: Any) -> None:
        self.folder = folder
        self.name = name
        self.stamp = stamp

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
        content = dumps(((self.stamp, key), data))
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


class Locator(UserProvidedCacheLocator):
    """The folder that `cache_directory` has chosen, which is not tried again for each function."""

    def ensure_cache_path(self) -> None:
        """Make the folder of one module."""
        with suppress(OSError):
            os.makedirs(self.get_cache_path(), exist_ok=True)


class Result(CompileResultCacheImpl):
    """What is kept of a compilation, and where."""

    _locator_classes: ClassVar = [Locator]


class KernelCache(FunctionCache):
    """The cache of one function."""

    _impl_class = Result

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        locator = self._impl.locator
        self._cache_file = Files(Path(locator.get_cache_path()), self._impl.filename_base, locator.get_source_stamp())

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep it if that can be; it is in memory anyway."""
        with suppress(OSError):
            super().save_overload(sig, data)
