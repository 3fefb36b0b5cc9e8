"""The file under a recording: whole records or nothing, whatever the disk does.

What is written waits in memory until `flush`. If the disk then refuses, the file is cut back to what was whole before,
and the room that was kept for that moment is given free for last words.
"""

import errno
import fcntl
import os
import stat
import time
from contextlib import suppress
from pathlib import Path

RESERVE = 256 * 1024  # bytes kept free for last words


class Sink:
    """A file for a writer: `write`, `tell`, `flush`."""

    def __init__(self, path: Path, fsync: bool = False) -> None:
        self.whole = 0  # bytes that are safely with the operating system
        self.longest = 0.0  # seconds that a flush took
        self._fsync = fsync
        self._waiting = bytearray()
        self._file = _opened(path)
        self._reserve = _reserved(path.parent)

    def write(self, data: bytes) -> int:
        """Keep it until the next flush."""
        self._waiting += data
        return len(data)

    def tell(self) -> int:
        """Length of the file with what waits."""
        return self.whole + len(self._waiting)

    def flush(self) -> None:
        """Hand all to the operating system, to the disk itself if asked to. Raises OSError, the file cut back."""
        start = time.monotonic()
        try:
            self._hand_over()
        except OSError:
            self._cut_back()
            raise
        finally:
            self.longest = max(self.longest, time.monotonic() - start)
        self.whole += len(self._waiting)
        self._waiting.clear()

    def close(self) -> None:
        """Flush and close."""
        try:
            self.flush()
        finally:
            self.abandon()

    def abandon(self) -> None:
        """Close the file as it is."""
        self._free_reserve()
        if self._file >= 0:
            os.close(self._file)
        self._file = -1

    def _hand_over(self) -> None:
        with memoryview(self._waiting) as view:
            done = 0
            while done < len(view):
                done += os.write(self._file, view[done:])
        if self._fsync:
            os.fsync(self._file)

    def _cut_back(self) -> None:
        self._waiting = bytearray()  # the old one may still be looked at
        os.ftruncate(self._file, self.whole)
        os.lseek(self._file, self.whole, os.SEEK_SET)
        self._free_reserve()

    def _free_reserve(self) -> None:
        if self._reserve is not None:
            os.close(self._reserve)
            self._reserve = None


def _opened(path: Path) -> int:
    """An empty file, ours as long as it is open. Raises OSError with the way out."""
    try:
        with suppress(FileExistsError):  # a file of that name: to open what lies in it says so better
            path.parent.mkdir(parents=True, exist_ok=True)
        return _locked(path)
    except OSError as error:
        words = f"{error.strerror}; record elsewhere: --record FILE with run, --output with other verbs"
        raise OSError(error.errno, words, str(path)) from None


def _locked(path: Path) -> int:
    """An empty file. Raises OSError when another program is recording to it."""
    file = os.open(path, os.O_CREAT | os.O_WRONLY | os.O_CLOEXEC, 0o644)
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(file)
        raise OSError(errno.EBUSY, "another program is recording to it", str(path)) from None
    except OSError:
        pass  # a file system without locks
    if stat.S_ISREG(os.fstat(file).st_mode):
        os.ftruncate(file, 0)
    return file


def _reserved(folder: Path) -> int | None:
    """A nameless file that holds some room, given free when it is closed; None where there is none to be had."""
    try:
        file = os.open(folder, os.O_TMPFILE | os.O_WRONLY | os.O_CLOEXEC)
    except OSError:
        return None
    try:
        os.posix_fallocate(file, 0, RESERVE)
    except OSError:
        os.close(file)
        return None
    return file
