"""Open a chunk of an MCAP file: by its header where that is sound, else by the compressed frame found in it."""

import struct
import zlib
from typing import Any, NamedTuple

import lz4.frame
import zstandard
from mcap.opcode import Opcode

from bridge.recording.layout import RECORD

FIXED = struct.Struct("<QQQII")  # first and last log time, size and checksum when unpacked, length of the next field
FRAMES = {b"\x28\xb5\x2f\xfd": "zstd", b"\x04\x22\x4d\x18": "lz4"}  # how their frames begin
NEAR = 24  # bytes after the fixed fields within which the frame begins
PIECE = 1 << 12  # bytes handed to a decompressor at a time; they unpack to 128 MiB at most
MOST = 1 << 27  # bytes: no chunk may unpack to more. Ours have 1 MiB, those of others some MiB

ALWAYS = 1 << 27  # bytes that any file may unpack to
RATIO = 20  # and so many for each of its own; ours have 2 to 3


class UnpackedError(Exception):
    """A small file that would fill the memory, or take forever."""


class Meter:
    """How much was unpacked of a file, sound or not. Raises UnpackedError once it is far more than recordings have."""

    def __init__(self, size: int) -> None:
        self._size = size  # of the file [bytes]
        self.unpacked = 0  # bytes

    def add(self, length: int) -> None:
        """Count bytes."""
        self.unpacked += length
        if self.unpacked > (most := ALWAYS + RATIO * self._size):
            raise UnpackedError(f"{self._size} bytes that unpack to more than {most}: not a recording to be read")


class Opened(NamedTuple):
    """What is in a chunk."""

    records: bytes
    end: int  # where the next record of the file begins
    whole: bool  # False: the file ends within the chunk


class Frame(NamedTuple):
    """The compressed part of a chunk."""

    kind: str
    at: int


def span(data: Any, at: int) -> tuple[int, int] | None:
    """First and last log time as the chunk at a place states them."""
    begin = at + RECORD.size
    if begin + FIXED.size > len(data):
        return None
    first, last, *_ = FIXED.unpack_from(data, begin)
    return (first, last) if first <= last < 1 << 63 else None


def open_chunk(data: Any, at: int, meter: Meter) -> Opened | None:
    """The records of the chunk at a place; None where they are damaged, or there is no chunk.

    meter: counts what it takes to find that out.
    """
    begin = at + RECORD.size
    if begin + FIXED.size > len(data):
        return None
    _, _, size, checksum, _ = FIXED.unpack_from(data, begin)
    frame = _frame(data, begin + FIXED.size)
    opcode, length = RECORD.unpack_from(data, at)
    if frame is None:
        return _stored(data, at, checksum) if opcode == Opcode.CHUNK or checksum else None
    end = begin + length
    records = _unpacked_at_once(data[frame.at : end], frame.kind, size) if end <= len(data) else None
    meter.add(len(records or b""))
    if records is not None and _right(records, checksum):
        return Opened(records, end, True)
    opened = _by_frame(data, frame, checksum, meter)
    return opened if opened is not None and (opened.whole or end > len(data)) else None


def is_compressed_chunk(data: Any, at: int) -> bool:
    """Does a compressed frame begin where one would in a chunk at this place?"""
    return _frame(data, at + RECORD.size + FIXED.size) is not None


def _frame(data: Any, at: int) -> Frame | None:
    for begin, kind in FRAMES.items():
        place = data.find(begin, at, at + NEAR)
        if place >= 0:
            return Frame(kind, place)
    return None


def _right(records: bytes, checksum: int) -> bool:
    return not checksum or zlib.crc32(records) == checksum


def _unpacked_at_once(packed: bytes, kind: str, size: int) -> bytes | None:
    """The quick way, where the frame itself confirms the size that the chunk states."""
    try:
        if kind == "lz4":
            return _unpacked_lz4(packed, size) if size < MOST else None
        return zstandard.decompress(packed, size) if zstandard.frame_content_size(packed) == size < MOST else None
    except (zstandard.ZstdError, RuntimeError, MemoryError):
        return None


def _unpacked_lz4(packed: bytes, size: int) -> bytes | None:
    """At most so many bytes: a frame of lz4 need not state its size."""
    decoder: Any = lz4.frame.LZ4FrameDecompressor()
    records = decoder.decompress(packed, max_length=size + 1)
    return records if decoder.eof and len(records) == size else None


def _by_frame(data: Any, frame: Frame, checksum: int, meter: Meter) -> Opened | None:
    """What the frame gives, whatever the header says: a frame knows its own end."""
    decoder: Any = lz4.frame.LZ4FrameDecompressor() if frame.kind == "lz4" else _zstd()
    parts, at, length = [], frame.at, 0
    try:
        while not decoder.eof and at < len(data) and length < MOST:
            parts.append(decoder.decompress(data[at : at + PIECE]))
            length += len(parts[-1])
            meter.add(len(parts[-1]))
            at += PIECE
    except (zstandard.ZstdError, RuntimeError, MemoryError, EOFError):
        return None
    if length >= MOST:
        return None
    records = b"".join(parts)
    if not decoder.eof:
        return Opened(records, len(data), False)
    end = min(at, len(data)) - len(decoder.unused_data or b"")
    return Opened(records, end, True) if checksum and zlib.crc32(records) == checksum else None


def _zstd() -> Any:
    return zstandard.ZstdDecompressor().decompressobj()


def _stored(data: Any, at: int, checksum: int) -> Opened | None:
    """A chunk that is not compressed, by the length that it or the record around it states."""
    begin = at + RECORD.size + FIXED.size + 8  # an empty name, and the length of what follows
    if begin > len(data) or FIXED.unpack_from(data, at + RECORD.size)[4]:
        return None
    stated = struct.unpack_from("<Q", data, begin - 8)[0]
    for end in (begin + stated, at + RECORD.size + RECORD.unpack_from(data, at)[1]):
        if begin <= end <= len(data) and _right(records := data[begin:end], checksum):
            return Opened(records, end, True)
    return None


def stored_records(data: Any, at: int) -> int | None:
    """Where the records begin in a chunk that is not compressed and of which the end is missing."""
    begin = at + RECORD.size
    if begin + FIXED.size + 8 > len(data):
        return None
    name, stated = FIXED.unpack_from(data, begin)[4], struct.unpack_from("<Q", data, begin + FIXED.size)[0]
    first = begin + FIXED.size + 8
    return first if name == 0 and first + stated > len(data) else None
