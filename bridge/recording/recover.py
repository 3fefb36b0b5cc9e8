"""Make recordings whole again: copy what is sound of damaged files, or join the parts of one run."""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Metadata
from mcap.writer import CompressionType, Writer

from bridge.errors import RunError, UsageError
from bridge.recording.channels import Channels
from bridge.recording.damage import Damage, damage
from bridge.recording.facts import facts_of
from bridge.recording.layout import MESSAGE, parsed
from bridge.recording.replace import whole_file
from bridge.recording.scan import Piece, Scan, contents, described_at_end, inside

CHUNK = 1024 * 1024  # bytes


class Recovered(NamedTuple):
    """What became of it."""

    path: Path
    messages: int
    damaged: int  # chunks that were left out
    whole: bool  # was there nothing to recover?
    notes: tuple[str, ...] = ()  # what is missing, in words


class Copy:
    """A file made from the records of others, whose numbers of channels and schemas are their own."""

    def __init__(self, writer: Writer) -> None:
        self.messages = 0
        self._writer = writer
        self._schemas: dict[tuple[str, bytes], int] = {}
        self._channels: dict[tuple[str, int], int] = {}
        self._described = Channels()  # by the file that is being copied
        self._numbers: dict[int, int] = {}  # of its channels: there -> here
        self._said: set[tuple[str, str]] = set()

    def begin(self, described: Channels) -> None:
        """From here on records are another file's."""
        self._described = described
        self._numbers = {number: self._channel(channel) for number, channel in described.channels.items()}

    def message(self, head: tuple[int, ...], data: bytes) -> None:
        """Copy a message, if its channel is known."""
        channel, sequence, log_time, publish_time = head
        number = self._numbers.get(channel)
        if number is not None:
            self._writer.add_message(number, log_time, data, publish_time, sequence)
            self.messages += 1

    def add(self, record: Metadata | Attachment) -> None:
        """Copy what stands beside the messages, as far as it can be what it says."""
        if isinstance(record, Attachment):
            words = record.create_time, record.log_time, record.name, record.media_type, record.data
            self._writer.add_attachment(*words)
        elif facts_of(record) is not None:
            self._say(record.name, record.metadata)

    def _channel(self, channel: Channel) -> int:
        schema = self._schema(channel.schema_id)
        key = channel.topic, schema
        if key not in self._channels:
            encoding, facts = channel.message_encoding, channel.metadata
            self._channels[key] = self._writer.register_channel(channel.topic, encoding, schema, facts)
        return self._channels[key]

    def _schema(self, number: int) -> int:
        schema = self._described.schemas.get(number)
        if schema is None:
            return 0
        key = schema.name, schema.data
        if key not in self._schemas:
            self._schemas[key] = self._writer.register_schema(schema.name, schema.encoding, schema.data)
        return self._schemas[key]

    def _say(self, name: str, values: dict[str, str]) -> None:
        said = name, repr(sorted(values.items()))
        if said not in self._said and not name.startswith("part"):
            self._writer.add_metadata(name, values)
        self._said.add(said)


class Survey(NamedTuple):
    """What there is in a file to copy."""

    profile: str
    channels: Channels
    damage: Damage
    worth: int  # how much there is: messages, channels, facts


def recover(files: list[Path], output: Path) -> Recovered:
    """Write all that is sound in some files, in their order, to one.

    Raises UsageError for what is not MCAP, RunError when there is nothing in it to recover; no file is written then.
    """
    _refuse_overwriting(files, output)
    surveys = [_survey(path) for path in files]
    if not any(survey.worth for survey in surveys):
        raise RunError(f"{', '.join(map(str, files))}: nothing could be recovered, and no file was written")
    with whole_file(output) as file:
        writer = Writer(file, chunk_size=CHUNK, compression=CompressionType.ZSTD)
        writer.start(profile=surveys[0].profile, library="hydrotwin recover")
        copy = Copy(writer)
        for path, survey in zip(files, surveys, strict=True):
            copy.begin(survey.channels)
            _copy(path, survey.channels, copy)
        damaged = sum(survey.damage.chunks for survey in surveys)
        whole = all(survey.damage.nothing for survey in surveys)
        if not whole:
            facts = {"from": ", ".join(path.name for path in files), "damaged_chunks": str(damaged)}
            writer.add_metadata("recovered", facts)
        writer.finish()
    return Recovered(output, copy.messages, damaged, whole, tuple(_words(files, surveys)))


def _refuse_overwriting(files: list[Path], output: Path) -> None:
    if any(path.exists() and output.exists() and path.samefile(output) for path in files):
        raise UsageError(f"{output}: would overwrite what it is made from; name another file with --output")


def _words(files: list[Path], surveys: list[Survey]) -> Iterator[str]:
    for path, survey in zip(files, surveys, strict=True):
        for words in survey.damage.words():
            yield f"{path.name}: {words}" if len(files) > 1 else words


def _survey(path: Path) -> Survey:
    """Look a file through before anything is written: what it says of its channels may stand at its end."""
    with contents(path) as data:
        channels = Channels(described_at_end(data))
        found = _look_through(data, channels)
        if found.damage.nameless or found.damage.records:
            found = _look_through(data, channels)
    return found


def _look_through(data: Any, channels: Channels) -> Survey:
    scan, profile, facts, messages = Scan(data, channels.topics), "", 0, Counter[int]()
    for piece in scan:
        if piece.opcode == Opcode.HEADER:
            profile = piece.record.profile
        facts += piece.opcode in (Opcode.METADATA, Opcode.ATTACHMENT)
        for opcode, begin, end, content in _within(piece):
            if opcode == Opcode.MESSAGE:
                messages[MESSAGE.unpack_from(content, begin)[0]] += 1
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                channels.add(parsed(opcode, content[begin:end]))
    nameless = sum(count for number, count in messages.items() if number not in channels.channels)
    worth = facts + len(channels.channels) + messages.total() - nameless
    return Survey(profile, channels, damage(scan, nameless), worth)


def _within(piece: Piece) -> Iterator[tuple[int, int, int, bytes]]:
    """The records of a chunk, or the one that a piece is: opcode, begin, end, and in what."""
    if piece.opcode != Opcode.CHUNK:
        yield piece.opcode, 0, len(piece.content), piece.content
        return
    for opcode, begin, end in inside(piece.content):
        if opcode != Opcode.MESSAGE or end - begin >= MESSAGE.size:
            yield opcode, begin, end, piece.content


def _copy(path: Path, channels: Channels, copy: Copy) -> None:
    with contents(path) as data:
        for piece in Scan(data, channels.topics):
            if piece.opcode in (Opcode.METADATA, Opcode.ATTACHMENT):
                copy.add(piece.record)
            for opcode, begin, end, content in _within(piece):
                if opcode == Opcode.MESSAGE:
                    copy.message(MESSAGE.unpack_from(content, begin), content[begin + MESSAGE.size : end])
