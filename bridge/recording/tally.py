"""Losses of a recording: gaps in the sequences of each publisher, and what was announced and never came."""

from collections.abc import Mapping
from typing import NamedTuple


class Seen(NamedTuple):
    """What has come of one publisher on one topic."""

    first: int  # sequence
    last: int
    came: int


class Tally:
    """Counts per topic and source. `from_start`: nothing had been sent before, so sequences begin at 0."""

    def __init__(self, from_start: bool) -> None:
        self._from_start = from_start
        self._seen: dict[tuple[str, int], Seen] = {}
        self._announced: dict[str, int] = {}

    def add(self, topic: str, source: int, sequence: int) -> None:
        """Take note of a message."""
        first = 0 if self._from_start else sequence
        seen = self._seen.get((topic, source), Seen(first, sequence, 0))
        self._seen[topic, source] = Seen(min(seen.first, sequence), max(seen.last, sequence), seen.came + 1)

    def announce(self, counts: Mapping[str, int]) -> None:
        """How many messages a publisher says it has sent, per topic."""
        self._announced |= counts

    def losses(self) -> dict[str, int]:
        """Messages that were sent and did not come, per topic; of a topic with an intruder, the busiest source's."""
        busiest: dict[str, Seen] = {}
        for (topic, _), seen in self._seen.items():
            if topic not in busiest or seen.came > busiest[topic].came:
                busiest[topic] = seen
        lost = {topic: self._missing(topic, busiest.get(topic)) for topic in {*busiest, *self._announced}}
        return {topic: count for topic, count in sorted(lost.items()) if count > 0}

    def _missing(self, topic: str, seen: Seen | None) -> int:
        sent = self._announced.get(topic, 0)
        if seen is None:
            return sent if self._from_start else 0
        return max(sent, seen.last + 1) - seen.first - seen.came
