"""Wall time: absolute deadlines, hybrid waiting, what real-time rights the system grants."""

import time
from collections.abc import Callable, Iterator
from itertools import count
from typing import NamedTuple

SPIN_NS = 150_000  # the last stretch before a deadline is spun through; sleep alone wakes some 70 us late


class Tick(NamedTuple):
    """A deadline met: which one, when it was due and how late it is [ns of the monotonic clock]."""

    number: int
    due: int
    lateness: int
    skipped: int = 0  # periods that it is due later than by its number


def ticks(
    period_ns: float,
    now: Callable[[], int] = time.monotonic_ns,
    sleep: Callable[[float], None] = time.sleep,
    spin_ns: int = SPIN_NS,
    skip: bool = False,
) -> Iterator[Tick]:
    """Wait for start + k * period, k = 1, 2, ...: delays never add up, missed ticks come back to back.

    skip: they do not hurry; after a tick that was periods late all further ones are due so many periods later.
    """
    start, skipped = now(), 0
    for k in count(1):
        due = start + round((k + skipped) * period_ns)
        if (wait := due - now() - spin_ns) > 0:
            sleep(wait * 1e-9)
        while (lateness := now() - due) < 0:
            pass
        yield Tick(k, due, lateness, skipped)
        skipped += int(lateness // period_ns) if skip else 0


class Overruns:
    """Ticks that came a period or more late: how many, how many times in a row, how long, how many in the worst row."""

    def __init__(self, period_ns: float, grace_ns: float) -> None:
        self.period = period_ns
        self.grace = grace_ns
        self.count = 0
        self.ticks = 0  # that were late; a row of them counts once in `count`
        self.worst = 0  # [ns]
        self.burst = 0  # most ticks that had to be caught up in a row
        self._running = 0

    def beyond(self, ticks: float, length: float) -> bool:
        """Are more ticks late, or one of them later [ns], than a run may have?"""
        return self.ticks > ticks or self.worst > length

    def add(self, lateness: int, elapsed: float) -> None:
        """Take note of a tick's lateness; `elapsed`: wall time since the start [ns]."""
        if lateness < self.period or elapsed < self.grace:
            self._running = 0
            return
        self.count += self._running == 0
        self.ticks += 1
        self._running += 1
        self.worst = max(self.worst, lateness)
        self.burst = max(self.burst, self._running)
