"""The messages of a recording in little memory: an hour at 1 kHz is twenty million of them."""

from array import array
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, overload

WHERE = "Q"  # of an array of places


class Entry(NamedTuple):
    """One recorded message."""

    topic: str  # below the rig's name
    log_time: int
    sequence: int
    data: bytes


class Lane:
    """What came on one topic, one message behind the other."""

    def __init__(self, code: int) -> None:
        self.code = code  # of the topic
        self.data = bytearray()
        self.ends = array(WHERE)

    def __getitem__(self, row: int) -> bytes:
        return bytes(self.data[self.ends[row - 1] if row else 0 : self.ends[row]])

    def __iter__(self) -> Iterator[bytes]:
        return (self[row] for row in range(len(self.ends)))


class Entries(Sequence[Entry]):
    """Messages in their order. An `Entry` is made when somebody looks at it."""

    def __init__(self, entries: Iterable[Entry] = ()) -> None:
        self._lanes: dict[str, Lane] = {}
        self._topics: list[str] = []  # by code
        self._codes = array("I")  # a file may describe 65536 channels, and messages of none
        self._times = array("q")
        self._sequences = array("Q")
        self._rows = array(WHERE)  # each one's place in its lane
        for entry in entries:
            self.add(*entry)

    def add(self, topic: str, log_time: int, sequence: int, data: bytes) -> None:
        """Put a message behind the others."""
        lane = self._lanes.get(topic)
        if lane is None:
            lane = self._new_lane(topic)
        lane.data += data
        self._codes.append(lane.code)
        self._times.append(log_time)
        self._sequences.append(sequence)
        self._rows.append(len(lane.ends))
        lane.ends.append(len(lane.data))

    def of(self, topic: str) -> Iterator[Entry]:
        """The messages of one topic."""
        if topic not in self._lanes:
            return iter(())
        code = self._lanes[topic].code
        return (self[place] for place, found in enumerate(self._codes) if found == code)

    def lane(self, topic: str) -> Lane:
        """The contents of one topic's messages."""
        return self._lanes.get(topic, Lane(0))

    def __len__(self) -> int:
        return len(self._codes)

    @overload
    def __getitem__(self, index: int) -> Entry: ...

    @overload
    def __getitem__(self, index: slice) -> list[Entry]: ...

    def __getitem__(self, index: int | slice) -> Entry | list[Entry]:
        if isinstance(index, slice):
            return [self[place] for place in range(*index.indices(len(self)))]
        topic = self._topics[self._codes[index]]
        return Entry(topic, self._times[index], self._sequences[index], self._lanes[topic][self._rows[index]])

    def __iter__(self) -> Iterator[Entry]:
        return (self[place] for place in range(len(self)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Sequence):
            return NotImplemented
        return len(self) == len(other) and all(one == two for one, two in zip(self, other, strict=True))

    def _new_lane(self, topic: str) -> Lane:
        self._topics.append(topic)
        return self._lanes.setdefault(topic, Lane(len(self._topics) - 1))
