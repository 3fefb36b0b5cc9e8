"""Walk an MCAP file whatever has happened to it: cut off, bits wrong, blocks overwritten.

A chunk is sound when its checksum says so, another record when its fields fill it exactly. Behind a place that is
neither, the walk continues at the next sound record.
"""

import mmap
import re
import zlib
from collections.abc import Container, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from mcap.opcode import Opcode

from bridge.errors import UsageError
from bridge.recording.chunk import Meter, UnpackedError, is_compressed_chunk, open_chunk, span, stored_records
from bridge.recording.layout import (
    CHUNK_INDEX,
    FOOTER,
    KNOWN,
    MAGIC,
    MESSAGE,
    READ,
    RECORD,
    SHAPES,
    fits,
    follows,
    head,
    parsed,
    resembles_magic,
)

CANDIDATE = re.compile(rb"(?=[\x01-\x0f].{4}\x00{4})", re.DOTALL)  # opcode, and a length below 4 GiB
Span = tuple[int, int]  # first and last log time [ns]


class Piece(NamedTuple):
    """A sound record of a file; of a chunk the records in it."""

    opcode: int
    content: bytes
    record: Any = None  # of those that are more than numbers


class Scan:
    """The sound records of a file, in its order, and what was found on the way.

    channels: numbers of those that are known so far; who takes the pieces adds to it.
    """

    def __init__(self, data: Any, channels: Container[int]) -> None:
        self.ended = len(data) > 2 * len(MAGIC) and resembles_magic(data[-len(MAGIC) :])
        self.chunks = 0  # sound ones
        self.chunks_lost = 0
        self.records_lost = 0  # others that are damaged; none of them a chunk
        self._data = data
        self._spans: list[Span | None] = []  # of chunks that were lost
        self._sound: set[int] = set()  # places of chunks
        self._index: dict[int, Span] = {}  # what the file's own index says: place of a chunk -> its span
        self._channels = channels
        self._meter = Meter(len(data))
        self._sizes: set[tuple[int, int]] = set()  # of messages, by channel

    def spans(self) -> list[Span]:
        """Log times of the chunks that were lost, as far as they are known."""
        if not self.chunks_lost:
            return []
        missing = [span for place, span in self._index.items() if place not in self._sound]
        return sorted(missing or [span for span in self._spans if span is not None])

    def __iter__(self) -> Iterator[Piece]:
        at = len(MAGIC)
        while at < len(self._data) and not self._at_end(at):
            piece, end = self._record(at)
            if piece is not None:
                yield piece
            at = end

    def _at_end(self, at: int) -> bool:
        return self.ended and at >= len(self._data) - len(MAGIC)

    def _record(self, at: int) -> tuple[Piece | None, int]:
        """The sound record at a place, and where the next one begins."""
        found = head(self._data, at)
        if found is None:
            return None, len(self._data)
        opcode, begin, end = found
        if opcode != Opcode.CHUNK and (piece := self._sound_record(opcode, begin, end)):
            return self._noted(piece), end
        opened = open_chunk(self._data, at, self._meter)
        if opened is not None:
            self.chunks += opened.whole
            self._sound.add(at)
            return Piece(Opcode.CHUNK, opened.records), opened.end
        if opcode not in KNOWN and opcode and follows(self._data, end):
            return None, end  # a kind of record that later versions of MCAP may have
        return None, self._beyond(at, opcode, end)

    def _sound_record(self, opcode: int, begin: int, end: int) -> Piece | None:
        data = self._data
        if end > len(data):
            return None
        if opcode == Opcode.MESSAGE:
            return Piece(opcode, data[begin:end]) if self._is_message(begin, end) else None
        if opcode not in SHAPES or not fits(data, begin, end, SHAPES[opcode]):
            return None
        content = data[begin:end]
        if opcode not in READ:
            return Piece(opcode, content)
        record = parsed(opcode, content)
        damaged = record is None or (opcode == Opcode.ATTACHMENT and not _attachment_is_right(content))
        return None if damaged else Piece(opcode, content, record)

    def _is_message(self, begin: int, end: int) -> bool:
        channel, size = int.from_bytes(self._data[begin : begin + 2], "little"), end - begin
        if size < MESSAGE.size or channel not in self._channels:
            return False
        usual = self._may_follow_a_message(end)
        if usual:
            self._sizes.add((channel, size))
        return usual or (channel, size) in self._sizes

    def _may_follow_a_message(self, at: int) -> bool:
        """Another record: its opcode or its length may be wrong, or the file cut off there."""
        if follows(self._data, at) or self._data[at] in KNOWN:
            return True
        found = head(self._data, at)
        return found is not None and found[2] < len(self._data) and follows(self._data, found[2])

    def _noted(self, piece: Piece) -> Piece:
        """Take note of what helps to find the way."""
        if piece.opcode == Opcode.CHUNK_INDEX:
            first, last, place = CHUNK_INDEX.unpack_from(piece.content)
            self._index[place] = first, last
        return piece

    def _beyond(self, at: int, opcode: int, end: int) -> int:
        """Where to continue behind a record that is damaged or cut off; it is counted."""
        inside = stored_records(self._data, at) if opcode == Opcode.CHUNK else None
        if inside is not None:
            return inside  # cut off: its records are walked one by one
        following = end if opcode in KNOWN and follows(self._data, end) else self._next_sound(at + 1)
        if following == len(self._data) < end and opcode in KNOWN:
            return following  # not damaged: the file was cut off within it
        self._lose(at, opcode, following)
        return following

    def _lose(self, at: int, opcode: int, following: int) -> None:
        if opcode == Opcode.CHUNK or is_compressed_chunk(self._data, at):
            self.chunks_lost += 1
            self._spans.append(span(self._data, at))
        else:
            self.records_lost += 1

    def _next_sound(self, at: int) -> int:
        for candidate in CANDIDATE.finditer(self._data, at):
            place = candidate.start()
            if self._stands_alone(place):
                return place
        return len(self._data)

    def _stands_alone(self, at: int) -> bool:
        """Is there beyond doubt a record at a place?"""
        found = head(self._data, at)
        if found is None or found[2] > len(self._data) or not follows(self._data, found[2]):
            return False
        if found[0] == Opcode.CHUNK:
            return open_chunk(self._data, at, self._meter) is not None
        return self._sound_record(*found) is not None


def _attachment_is_right(content: bytes) -> bool:
    checksum = int.from_bytes(content[-4:], "little")
    return not checksum or zlib.crc32(content[:-4]) == checksum


def described_at_end(data: Any) -> Iterator[Any]:
    """The types and channels that the summary of a file repeats, if its checksum is right."""
    footer = len(data) - len(MAGIC) - FOOTER.size - RECORD.size
    if footer < 0 or head(data, footer) != (Opcode.FOOTER, footer + RECORD.size, footer + RECORD.size + FOOTER.size):
        return
    start, _, checksum = FOOTER.unpack_from(data, footer + RECORD.size)
    if not checksum or not 0 < start <= footer or zlib.crc32(data[start : len(data) - len(MAGIC) - 4]) != checksum:
        return
    summary = data[start:footer]
    for opcode, begin, end in inside(summary):
        if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            yield parsed(opcode, summary[begin:end])


def inside(records: bytes) -> Iterator[tuple[int, int, int]]:
    """Opcode, begin and end of each whole record of a chunk."""
    at, unpack = 0, RECORD.unpack_from
    while at + RECORD.size <= len(records):
        opcode, length = unpack(records, at)
        begin = at + RECORD.size
        at = begin + length
        if at > len(records):
            return
        yield opcode, begin, at


@contextmanager
def contents(path: Path) -> Iterator[Any]:
    """The bytes of a file that begins like MCAP. Raises UsageError with one line for any other."""
    try:
        with path.open("rb") as file:
            data = _mapped(file)
            if not resembles_magic(data[: len(MAGIC)]):
                raise UsageError(f"{path}: not an MCAP file")
            yield data
    except UnpackedError as error:
        raise UsageError(f"{path}: {error}") from None
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}") from None


def _mapped(file: Any) -> Any:
    try:
        return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    except (OSError, ValueError):
        return file.read()  # empty, or not a file on a disk
