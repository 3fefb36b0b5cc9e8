"""Read a recording back: messages, columns, metadata; of a damaged file what is sound, and what is missing."""

import logging
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap.opcode import Opcode
from numpy.typing import NDArray

from bridge.errors import UsageError
from bridge.recording.channels import ChannelFacts, Channels
from bridge.recording.damage import Damage, damage
from bridge.recording.entries import Entries, Entry
from bridge.recording.facts import facts_of
from bridge.recording.layout import MESSAGE, READ, RECORD, parsed
from bridge.recording.own_signals import TOPIC as OWN_SIGNALS
from bridge.recording.own_signals import own_columns
from bridge.recording.scan import Piece, Scan, contents, described_at_end, inside
from bridge.scenario import Scenario, check
from bridge.scenario.channels import layout_of
from bridge.wire.channels import Layout, format_of, layout_in
from bridge.wire.codec import STORE, decode
from bridge.wire.messages import CHANNELS_TOPIC, TOPICS, field_names, flat_size, struct_format
from controller.grid import NS

LATEST = (1 << 63) - 1  # [ns]; a later time is none
HEAD = ("", "V4")  # of a message in CDR: how it is encoded

log = logging.getLogger("hydrotwin")


class Recording(NamedTuple):
    """What a file holds, in file order."""

    path: Path
    entries: Entries
    metadata: dict[str, dict[str, Any]]
    complete: bool  # False: messages are missing that had been recorded
    counts: dict[str, int]  # messages per topic, those not read included
    channels: Mapping[str, ChannelFacts] = {}  # per topic
    damage: Damage = Damage()

    def of(self, topic: str) -> Iterator[Entry]:
        """The messages of one topic."""
        return self.entries.of(topic)

    def messages(self, topic: str) -> list[Any]:
        """The decoded messages of one topic."""
        if topic == CHANNELS_TOPIC:
            return [decode(data, topic) for data in self.entries.lane(topic)]
        kind = TOPICS[topic].type
        return [STORE.deserialize_cdr(data, kind) for data in self.entries.lane(topic)]

    def columns(self, topic: str) -> dict[str, NDArray[Any]]:
        """A flat topic as one array per field; what laws log as one array per signal, too."""
        if topic == OWN_SIGNALS:
            return own_columns(self.messages(topic))
        names, layout = self._flat(topic)
        codes = {"Q": "<u8", "q": "<i8", "d": "<f8"}
        fields = [(n, codes[c]) for n, c in zip(names, layout[3:], strict=True)]
        rows = np.frombuffer(bytes(self.entries.lane(topic).data), dtype=[HEAD, *fields])
        return {name: rows[name] for name, _ in fields}

    def layout(self) -> Layout:
        """The further channels of the run: as the file describes them, else as its scenario does."""
        if CHANNELS_TOPIC in self.channels:
            return layout_in(self.channels[CHANNELS_TOPIC].definition)
        return layout_of(self.scenario()) if self.counts.get(CHANNELS_TOPIC) else ()

    def _flat(self, topic: str) -> tuple[list[str], str]:
        """The names of a flat topic's fields and its `struct` format. Raises ValueError for another topic."""
        kind = TOPICS[topic].type
        if topic == CHANNELS_TOPIC:
            further = self.layout()
            return [*field_names(kind), *(field.name for field in further)], format_of(further)
        layout = struct_format(kind)
        if layout is None:
            raise ValueError(f"{topic} has strings or lists and no columns")
        return field_names(kind), layout

    def scenario(self) -> Scenario:
        """The scenario of the run. Raises UsageError when the file carries none."""
        if "run" not in self.metadata:
            raise UsageError(f"{self.path}: the recording carries no scenario")
        return check(self.metadata["run"]["scenario"], str(self.path))


def recording(path: Path, entries: Iterable[Entry], metadata: dict[str, dict[str, Any]]) -> Recording:
    """A complete recording that is in memory."""
    kept = Entries(entries)
    return Recording(path, kept, metadata, True, dict(Counter(entry.topic for entry in kept)))


def read(path: Path, topics: Collection[str] | None = None, growing: bool = False) -> Recording:
    """Read a file, or some of its topics. Raises UsageError when there is none or it is not MCAP.

    What is missing is logged as a warning; growing: the file is still being written and has no end yet.
    """
    with contents(path) as data:
        content = _Content(Channels(described_at_end(data)), topics)
        content.take(Scan(data, content.channels.topics))
        if content.damage.nameless or content.damage.records:  # what is described further on may help
            content = _Content(content.channels, topics)
            content.take(Scan(data, content.channels.topics))
    found = content.recording(path)
    if not growing and (words := missing(found)):
        log.warning("%s: %s", path, "; ".join(words))
    return found


def missing(recording: Recording) -> list[str]:
    """What is missing in a recording, in words."""
    cut = []
    if recording.damage.cut:
        last = max((entry.log_time for entry in recording.entries), default=None)
        cut = ["cut off: it holds no messages" if last is None else f"cut off after t = {last / NS:g} s"]
    return cut + recording.damage.words()


SIZES = {name: flat_size(topic.type) for name, topic in TOPICS.items()}


def is_sound(topic: str, data: bytes) -> bool:
    """Is a message what its topic says? A file may come from anybody; of topics that are not ours nothing is said."""
    if topic not in SIZES:
        return True
    size = SIZES[topic]
    if size is not None:
        return len(data) == size
    try:
        decode(data, topic)
    except ValueError:
        return False
    return True


class _Content:
    """What a scan brings together."""

    def __init__(self, channels: Channels, topics: Collection[str] | None) -> None:
        self.channels = channels
        self.entries = Entries()
        self.counts: Counter[str] = Counter()
        self.metadata: dict[str, dict[str, Any]] = {}
        self.damage = Damage()
        self.unreadable = 0  # messages
        self._topics = topics

    def take(self, scan: Scan) -> None:
        """Take all that a scan finds."""
        for piece in scan:
            if piece.opcode == Opcode.CHUNK:
                self._take_chunk(piece.content)
            elif piece.opcode == Opcode.MESSAGE:
                self._take_chunk(RECORD.pack(piece.opcode, len(piece.content)) + piece.content)
            elif piece.opcode == Opcode.METADATA:
                self._take_metadata(scan, piece)
            else:
                self.channels.add(piece.record)
        nameless = self.counts.pop("", 0)  # messages of channels that are not described
        if nameless:
            self.entries = Entries(entry for entry in self.entries if entry.topic)
        self.damage = damage(scan, nameless)._replace(unreadable=self.unreadable)

    def recording(self, path: Path) -> Recording:
        """All of it."""
        whole = not self.damage.messages_missing
        counts, facts = dict(self.counts), self.channels.facts()
        return Recording(path, self.entries, self.metadata, whole, counts, facts, self.damage)

    def _take_chunk(self, records: bytes) -> None:
        topics, wanted, counts, add = self.channels.topics, self._topics, self.counts, self.entries.add
        for opcode, begin, end in inside(records):
            if opcode != Opcode.MESSAGE:
                self.channels.add(parsed(opcode, records[begin:end]) if opcode in READ else None)
            elif end - begin >= MESSAGE.size:
                channel, sequence, log_time, _ = MESSAGE.unpack_from(records, begin)
                topic, data = topics.get(channel, ""), records[begin + MESSAGE.size : end]
                if log_time > LATEST or not is_sound(topic, data):
                    self.unreadable += 1
                    continue
                counts[topic] += 1
                if wanted is None or topic in wanted:
                    add(topic, log_time, sequence, data)

    def _take_metadata(self, scan: Scan, piece: Piece) -> None:
        facts = facts_of(piece.record)
        if facts is None:
            scan.records_lost += 1
        else:
            self.metadata[piece.record.name] = facts
