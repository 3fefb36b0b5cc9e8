"""Make recordings whole again: copy what is sound of files that were cut off, or join the parts of one run."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import zstandard
from mcap.exceptions import McapError
from mcap.records import Attachment, Channel, Chunk, Header, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.writer import CompressionType, Writer

from bridge.errors import UsageError
from bridge.recording.reader import decompressed

CHUNK = 1024 * 1024  # bytes
BROKEN = (McapError, ValueError, KeyError, RuntimeError, zstandard.ZstdError)


class Recovered(NamedTuple):
    """What became of it."""

    path: Path
    messages: int
    damaged: int  # chunks that were left out
    whole: bool  # was there nothing to recover?


class Copy:
    """A file made from the records of others, whose numbers of channels and schemas are their own."""

    def __init__(self, writer: Writer) -> None:
        self.messages = 0
        self._writer = writer
        self._schemas: dict[tuple[str, bytes], int] = {}
        self._channels: dict[str, int] = {}
        self._of_file: tuple[dict[int, int], dict[int, int]] = ({0: 0}, {})
        self._said: set[tuple[str, str]] = set()

    def begin(self) -> None:
        """From here on records are another file's."""
        self._of_file = ({0: 0}, {})

    def add(self, record: Any) -> None:
        """Copy a record; what a file derives from others is made anew."""
        schemas, channels = self._of_file
        match record:
            case Schema():
                key = record.name, record.data
                if key not in self._schemas:
                    self._schemas[key] = self._writer.register_schema(record.name, record.encoding, record.data)
                schemas[record.id] = self._schemas[key]
            case Channel():
                if record.topic not in self._channels:
                    self._channels[record.topic] = self._writer.register_channel(
                        record.topic, record.message_encoding, schemas[record.schema_id], record.metadata
                    )
                channels[record.id] = self._channels[record.topic]
            case Message():
                channel, data = channels[record.channel_id], record.data
                self._writer.add_message(channel, record.log_time, data, record.publish_time, record.sequence)
                self.messages += 1
            case Metadata():
                self._say(record.name, record.metadata)
            case Attachment():
                words = record.create_time, record.log_time, record.name, record.media_type, record.data
                self._writer.add_attachment(*words)

    def _say(self, name: str, values: dict[str, str]) -> None:
        said = name, repr(sorted(values.items()))
        if said not in self._said and not name.startswith("part"):
            self._writer.add_metadata(name, values)
        self._said.add(said)


def recover(files: list[Path], output: Path) -> Recovered:
    """Write all that is sound in some files, in their order, to one. Raises UsageError for what is no MCAP."""
    if output.resolve() in {path.resolve() for path in files}:
        raise UsageError(f"{output}: would overwrite what it is made from; name another file with --output")
    state: dict[str, int] = {"damaged": 0, "cut": 0}
    try:
        with output.open("wb") as file:
            writer = Writer(file, chunk_size=CHUNK, compression=CompressionType.ZSTD)
            writer.start(profile=_profile(files[0]), library="hydrotwin recover")
            copy = Copy(writer)
            for path in files:
                copy.begin()
                for record in _sound(path, state):
                    copy.add(record)
            if state["cut"] or state["damaged"]:
                facts = {"from": ", ".join(path.name for path in files), "damaged_chunks": str(state["damaged"])}
                writer.add_metadata("recovered", facts)
            writer.finish()
    except OSError as error:
        raise UsageError(f"{error.filename or output}: {error.strerror}") from None
    return Recovered(output, copy.messages, state["damaged"], not (state["cut"] or state["damaged"]))


def _profile(path: Path) -> str:
    with path.open("rb") as file:
        if file.read(8) != b"\x89MCAP0\r\n":
            raise UsageError(f"{path}: not an MCAP file")
        file.seek(0)
        try:
            first = next(iter(StreamReader(file).records))
        except BROKEN:
            return ""
    return first.profile if isinstance(first, Header) else ""


def _sound(path: Path, state: dict[str, int]) -> Iterator[Any]:
    """The records of a file up to where it was cut off; a chunk that is damaged inside is left out."""
    with path.open("rb") as file:
        try:
            for record in StreamReader(file, emit_chunks=True).records:
                if not isinstance(record, Chunk):
                    yield record
                    continue
                try:
                    decompressed(record)
                    inside = breakup_chunk(record)
                except BROKEN:
                    state["damaged"] += 1
                    continue
                yield from inside
        except BROKEN:
            state["cut"] += 1
