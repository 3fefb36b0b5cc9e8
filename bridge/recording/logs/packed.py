"""The name and the bytes of a log: as they lie there, or unpacked from gzip up to a limit."""

import zlib
from pathlib import Path

from bridge.errors import UsageError, reason
from bridge.recording.logs.limits import MOST_BYTES, refuse_long, size_of

GZIP = b"\x1f\x8b"
PIECE = 1 << 20
PACKED_PIECE = 1 << 16  # of an archive: it unpacks to a thousand times as much at most
OF_GZIP = 16 + zlib.MAX_WBITS


def name_of(path: Path) -> str:
    """The name of a file or a folder; of "." and ".." that of the folder which is meant."""
    return path.resolve().name if path.name in ("", "..") else path.name


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


def content(path: Path) -> tuple[bytes, tuple[str, ...]]:
    """All bytes of a text, unpacked, and a sentence where an archive was cut off: its whole lines are taken then.

    Raises UsageError for more than a log may have, and for a damaged archive.
    """
    size_of(path)
    if not is_packed(path):
        return path.read_bytes(), ()
    raw, whole = _unpacked(path)
    if whole:
        return raw, ()
    end = raw.rfind(b"\n") + 1
    if not end or b"\0" in raw:  # of two bytes a letter, which a cut may part
        raise UsageError(f"{path}: is gzip that is cut off after {len(raw)} bytes unpacked; copy the whole file")
    return raw[:end], (f"the gzip file is cut off: what could be unpacked of it was read, {len(raw)} bytes",)


def _unpacked(path: Path) -> tuple[bytes, bool]:
    """What can be unpacked, of one archive after the other, and whether the last one has an end."""
    pieces: list[bytes] = []
    unpack, size = zlib.decompressobj(OF_GZIP), 0
    try:
        with path.open("rb") as file:
            while packed := file.read(PACKED_PIECE):
                while packed := packed.lstrip(b"\0") if unpack.eof else packed:  # zeros may fill up a block of a tape
                    unpack = zlib.decompressobj(OF_GZIP) if unpack.eof else unpack
                    pieces.append(unpack.decompress(packed))
                    size += len(pieces[-1])
                    refuse_long(path, float("inf") if size > MOST_BYTES else size)
                    packed = unpack.unused_data
    except zlib.error as error:
        raise UsageError(f"{path}: is gzip that is damaged, somewhere after {size} bytes unpacked ({error})") from None
    return b"".join(pieces), unpack.eof
