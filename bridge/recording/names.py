"""Names of files that no other run takes at the same moment."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path

from bridge.errors import UsageError


@contextmanager
def own_name(path: Path) -> Iterator[Path]:
    """The path, or where a file has that name already the same with -2, -3 and so on; it is ours from now on.

    Raises UsageError with one line where no file can be made. A file that is still empty at the end is taken away.
    """
    mine = _taken(path)
    try:
        yield mine
    finally:
        with suppress(OSError):
            if mine.stat().st_size == 0:
                mine.unlink()


def _taken(path: Path) -> Path:
    for number in count(1):
        candidate = path if number == 1 else path.with_stem(f"{path.stem}-{number}")
        try:
            candidate.parent.mkdir(parents=True, exist_ok=True)
            os.close(os.open(candidate, os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_CLOEXEC, 0o666))
        except FileExistsError:
            if candidate.parent.is_dir():
                continue
            raise UsageError(f"{candidate.parent}: is a file, not a folder; name another one") from None
        except OSError as error:
            raise UsageError(f"{candidate}: {error.strerror}; name a file in another folder") from None
        return candidate
    raise AssertionError("unreachable")
