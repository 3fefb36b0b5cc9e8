"""Small MCAP files to damage, and what mcap's own reader finds in what is made of them."""

import random
from pathlib import Path
from typing import NamedTuple

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

Message = tuple[str, int, int, bytes]  # topic, log time, sequence, data
KINDS = {"zstd": CompressionType.ZSTD, "lz4": CompressionType.LZ4, "stored": CompressionType.NONE, "unchunked": None}
TOPICS = ("rig/measurement", "rig/command")


class Small(NamedTuple):
    """A small file and what is in it."""

    data: bytes
    messages: list[Message]  # in the order of the file
    ends: list[int]  # of each message: where the chunk, or the record, that it is in ends
    fact: int  # where the first record of metadata ends


def small_file(path: Path, kind: str = "zstd", chunks: int = 4, each: int = 2, size: int = 16) -> Small:
    """Two topics in some chunks, metadata before and after."""
    noise, messages, ends = random.Random(1), [], []
    with path.open("wb") as file:
        compression = KINDS[kind] or CompressionType.NONE
        writer = Writer(file, compression=compression, use_chunking=kind != "unchunked")
        writer.start(profile="ros2", library="test")
        writer.add_metadata("user", {"operator": "Ada"})
        fact = file.tell()
        channels = [
            writer.register_channel(t, "cdr", writer.register_schema(t, "ros2msg", b"float64 x")) for t in TOPICS
        ]
        for number in range(chunks * each):
            topic, data = number % len(TOPICS), noise.randbytes(size)
            writer.add_message(channels[topic], number * 1000, data, number * 1000, number)
            messages.append((TOPICS[topic], number * 1000, number, data))
            if kind == "unchunked" or (number + 1) % each == 0:
                writer.flush()
                ends += [file.tell()] * (len(messages) - len(ends))
        writer.add_metadata("later", {"a": "b"})
        writer.finish()
    return Small(path.read_bytes(), messages, ends, fact)


def read_by_mcap(path: Path) -> list[Message]:
    """Every message by mcap's own reader, checksums looked at; the statistics must say as many."""
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        found = [
            (channel.topic, message.log_time, message.sequence, message.data)
            for _, channel, message in reader.iter_messages(log_time_order=False)
        ]
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == len(found)
    return found
