"""Write a run to MCAP: ROS 2 profile, CDR payloads, chunks closed and flushed by time.

`kill -9` loses at most what came since the last flush; nothing already on disk is ever rewritten.
"""

import json
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, cast

from mcap.data_stream import RecordBuilder
from mcap.records import ChunkIndex, Metadata
from mcap.writer import CompressionType, Writer

from bridge.errors import UsageError, reason
from bridge.recording.entries import Entry
from bridge.recording.reader import Recording
from bridge.recording.sink import Sink
from bridge.wire.channels import Layout, text_of
from bridge.wire.codec import channels_hash, encode, type_hash
from bridge.wire.messages import CHANNELS_TOPIC, OF_SOME_RUNS, TOPICS, Outgoing, definition
from controller.grid import NS

CHUNK = 8 * 1024 * 1024  # bytes; flushing by time closes them long before
LIST_OF_CHUNKS = "_Writer__chunk_indices"  # of the library's writer
FLUSH_PERIOD = NS // 5  # a kill is to lose no more than 0.25 s: this, and the time until it is noticed
QOS = """\
- history: 3
  depth: 0
  reliability: 1
  durability: 2
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: 1
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false
"""


def new_recording(path: Path, rig_name: str, channels: Layout = ()) -> "RecordingWriter":
    """A file of a run. Raises UsageError with one line when it cannot be made, or another run writes to it."""
    try:
        return RecordingWriter(path, rig_name, channels=channels)
    except OSError as error:
        raise UsageError(reason(error)) from None


def entries_of(messages: Iterable[Outgoing]) -> list[Entry]:
    """What belongs to one instant, in the order of a lockstep recording."""
    ordered = sorted(messages, key=lambda m: (m.log_time, m.topic, m.sequence))
    return [Entry(m.topic, m.log_time, m.sequence, encode(m.message)) for m in ordered]


def save(recording: Recording, path: Path, rig_name: str) -> Path:
    """Write a recording that is in memory. Raises UsageError where that cannot be, and for topics of others."""
    if foreign := sorted({entry.topic for entry in recording.entries} - set(TOPICS)):
        raise UsageError(
            f"{recording.path} holds topics that are not ours ({', '.join(foreign)}): copy the file itself"
        )
    writer = new_recording(path, rig_name, recording.layout())
    try:
        for name, values in recording.metadata.items():
            writer.metadata(name, values)
        for entry in recording.entries:
            writer.write(*entry)
            writer.flush_by(entry.log_time)
        writer.close()
    except OSError as error:
        raise UsageError(reason(error)) from None
    return path


class ChunkIndexes:
    """What the end of a file says of its chunks, as the bytes that are written there.

    In place of the library's list of objects, which takes eight times as much: 0.4 MB per minute.
    """

    def __init__(self) -> None:
        self._records = bytearray()

    def append(self, index: ChunkIndex) -> None:
        """Add a chunk."""
        builder = RecordBuilder()
        index.write(builder)
        self._records += builder.end()

    def __iter__(self) -> Iterator["ChunkIndexes"]:
        yield self

    def write(self, builder: RecordBuilder) -> None:
        """Write them all."""
        builder.write(bytes(self._records))


class RecordingWriter:
    """One file of one run. Whatever writes to the disk raises OSError; the file then ends with what was whole."""

    def __init__(
        self,
        path: Path,
        rig_name: str,
        topics: Collection[str] | None = None,
        fsync: bool = False,
        channels: Layout = (),
    ) -> None:
        """topics: to describe from the start, None for all; channels: the further ones of the run."""
        self.path = path
        self.rig_name = rig_name
        self._layout = channels
        self.pending: Counter[str] = Counter()  # messages per topic since the last flush
        self.span: tuple[int, int] | None = None  # first and last log time
        self.sink = Sink(path, fsync)
        # the writer writes, flushes and closes its stream, no more, and Sink does these
        self._writer = Writer(cast("IO[bytes]", self.sink), chunk_size=CHUNK, compression=CompressionType.ZSTD)
        setattr(self._writer, LIST_OF_CHUNKS, ChunkIndexes())
        self._writer.start(profile="ros2", library="hydrotwin")
        chosen = [name for name in TOPICS if (topics is None or name in topics) and name not in OF_SOME_RUNS]
        self._channels = {name: self._register(name) for name in chosen}
        self._flushed = 0

    def write(self, topic: str, log_time: int, sequence: int, payload: bytes) -> None:
        """Append one message."""
        if topic not in self._channels:
            self._channels[topic] = self._register(topic)
        self._writer.add_message(
            channel_id=self._channels[topic],
            log_time=log_time,
            publish_time=log_time,
            sequence=sequence & 0xFFFFFFFF,
            data=payload,
        )
        self.pending[topic] += 1
        begin, end = self.span or (log_time, log_time)
        self.span = min(begin, log_time), max(end, log_time)

    def instant(self, messages: Iterable[Outgoing]) -> list[Entry]:
        """Append what belongs to one instant, in the order of a lockstep recording."""
        entries = entries_of(messages)
        for entry in entries:
            self.write(*entry)
        if entries:
            self.flush_by(min(entry.log_time for entry in entries))
        return entries

    def metadata(self, name: str, values: Mapping[str, Any]) -> None:
        """Add a named record of facts about the run; values that are not text are written as JSON."""
        texts = {key: value if isinstance(value, str) else json.dumps(value) for key, value in values.items()}
        self._writer.add_metadata(name, texts)

    def flush_by(self, now: int) -> None:
        """Close and flush the chunk if its time [ns] has come."""
        if now - self._flushed >= FLUSH_PERIOD:
            self._flushed = now
            self.flush()

    def flush(self) -> None:
        """Close the chunk and hand everything to the operating system."""
        self._writer.flush()  # the sink too
        self.pending.clear()

    def close(self) -> None:
        """Write summary and index."""
        self._writer.finish()
        self.sink.close()

    def give_up(self, name: str, words: Mapping[str, str]) -> None:
        """After the disk has refused: last words into the room kept for them, and no more."""
        with suppress(OSError):
            self._last_words(name, words)
        self.sink.abandon()

    def _last_words(self, name: str, words: Mapping[str, str]) -> None:
        """A record past the writer: what waits in its chunk is lost with the disk's refusal."""
        record = RecordBuilder()
        Metadata(name=name, metadata=dict(words)).write(record)
        self.sink.write(record.end())
        self.sink.flush()

    def _register(self, name: str) -> int:
        kind = TOPICS[name].type
        text, its_hash = definition(kind), type_hash(kind)
        if name == CHANNELS_TOPIC:
            text, its_hash = text_of(self._layout), channels_hash(self._layout)
        schema = self._writer.register_schema(name=kind, encoding="ros2msg", data=text.encode())
        return self._writer.register_channel(
            topic=f"{self.rig_name}/{name}",
            message_encoding="cdr",
            schema_id=schema,
            metadata={"offered_qos_profiles": QOS, "topic_type_hash": its_hash},
        )
