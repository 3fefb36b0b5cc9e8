"""How MCAP lays out its records, as far as it takes to tell a sound record from a damaged one."""

import struct
from io import BytesIO
from typing import Any

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Header, Metadata, Schema

MAGIC = b"\x89MCAP0\r\n"
RECORD = struct.Struct("<BQ")  # opcode, length of the content
MESSAGE = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time
CHUNK_INDEX = struct.Struct("<QQQ")  # first and last log time, place of the chunk
FOOTER = struct.Struct("<QQI")  # where the summary begins, its offsets, its checksum
SHORT, LONG = "<I", "<Q"  # a field with its length before it
SHAPES: dict[int, tuple[int | str, ...]] = {  # bytes of fixed size, and fields with a length of their own
    Opcode.HEADER: (SHORT, SHORT),
    Opcode.FOOTER: (20,),
    Opcode.SCHEMA: (2, SHORT, SHORT, SHORT),
    Opcode.CHANNEL: (4, SHORT, SHORT, SHORT),
    Opcode.MESSAGE_INDEX: (2, SHORT),
    Opcode.CHUNK_INDEX: (32, SHORT, 8, SHORT, 16),
    Opcode.ATTACHMENT: (16, SHORT, SHORT, LONG, 4),
    Opcode.ATTACHMENT_INDEX: (40, SHORT, SHORT),
    Opcode.STATISTICS: (42, SHORT),
    Opcode.METADATA: (SHORT, SHORT),
    Opcode.METADATA_INDEX: (16, SHORT),
    Opcode.SUMMARY_OFFSET: (17,),
    Opcode.DATA_END: (4,),
}
READ: dict[int, Any] = {
    Opcode.HEADER: Header,
    Opcode.SCHEMA: Schema,
    Opcode.CHANNEL: Channel,
    Opcode.METADATA: Metadata,
    Opcode.ATTACHMENT: Attachment,
}
KNOWN = frozenset(int(opcode) for opcode in Opcode)


def resembles_magic(data: bytes) -> bool:
    """Does a file begin like MCAP, a wrong byte or two allowed?"""
    return len(data) == len(MAGIC) and sum(a != b for a, b in zip(data, MAGIC, strict=True)) <= 2


def head(data: Any, at: int) -> tuple[int, int, int] | None:
    """Opcode, begin and end of the content of the record at a place; None where none can be."""
    begin = at + RECORD.size
    if begin > len(data):
        return None
    opcode, length = RECORD.unpack_from(data, at)
    return opcode, begin, begin + length


def follows(data: Any, at: int) -> bool:
    """May a record, or the end of the file, be at a place?"""
    if at == len(data) or data[at : at + len(MAGIC)] == MAGIC:
        return True
    found = head(data, at)
    return found is not None and found[0] in KNOWN and found[2] <= len(data)


def fits(data: Any, begin: int, end: int, shape: tuple[int | str, ...]) -> bool:
    """Do the fields of a record fill its content exactly?"""
    at = begin
    for field in shape:
        if isinstance(field, int):
            at += field
            continue
        size = struct.calcsize(field)
        if at + size > end:
            return False
        at += size + struct.unpack_from(field, data, at)[0]
    return at == end


def parsed(opcode: int, content: bytes) -> Any:
    """A record that is more than numbers; None where it cannot be read."""
    try:
        return READ[opcode].read(ReadDataStream(BytesIO(content)))
    except (McapError, ValueError, KeyError, struct.error, OverflowError, MemoryError):
        return None
