"""The bytes of a log: as they lie there, or unpacked from gzip up to a limit."""

import gzip
import zlib
from pathlib import Path

from bridge.errors import UsageError, reason
from bridge.recording.logs.limits import MOST_BYTES, refuse_long, size_of

GZIP = b"\x1f\x8b"
PIECE = 1 << 20


def is_packed(path: Path) -> bool:
    """Does a file begin as gzip does?"""
    return head(path, len(GZIP)) == GZIP


def head(path: Path, length: int) -> bytes:
    """The first bytes of a file. Raises UsageError where it cannot be read."""
    try:
        with path.open("rb") as file:
            return file.read(length)
    except OSError as error:
        raise UsageError(reason(error) if error.filename else f"{path}: {error.strerror}") from None


def content(path: Path) -> bytes:
    """All bytes of a file, unpacked. Raises UsageError for more than a log may have, and for a damaged archive."""
    size_of(path)
    if not is_packed(path):
        return path.read_bytes()
    pieces, size = [], 0
    try:
        with gzip.open(path) as file:
            while piece := file.read(PIECE):
                size += len(piece)
                refuse_long(path, float("inf") if size > MOST_BYTES else size)
                pieces.append(piece)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise UsageError(f"{path}: is gzip that is damaged or cut off after {size} bytes unpacked ({error})") from None
    return b"".join(pieces)
