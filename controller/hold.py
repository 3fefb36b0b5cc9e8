"""Zero-order hold: each command acts from its own instant and is held until the next one acts."""

from collections import deque
from collections.abc import Iterator
from typing import NamedTuple


class Segment(NamedTuple):
    """A value held over [begin, end), times in ns."""

    begin: int
    end: int
    value: float


class Hold:
    """The value in force and those that are to follow. Commands are put in the order in which they act."""

    def __init__(self, value: float) -> None:
        self.value = value
        self.since = -1  # instant from which the last command that acted was meant to act [ns]
        self._pending: deque[tuple[int, float]] = deque()

    def put(self, apply_at: int, value: float) -> None:
        """Let a value act from `apply_at` [ns]; what was to act at or after that instant gives way."""
        while self._pending and self._pending[-1][0] >= apply_at:
            self._pending.pop()
        self._pending.append((apply_at, value))

    def insert(self, apply_at: int, value: float) -> None:
        """Let a value act from `apply_at` [ns] until what is to act after it."""
        later = [entry for entry in self._pending if entry[0] > apply_at]
        self.put(apply_at, value)
        self._pending.extend(later)

    def waiting(self) -> list[tuple[int, float]]:
        """What is to act, and from when on [ns]."""
        return list(self._pending)

    def at(self, instant: int) -> float:
        """The value that acts just before an instant [ns], as far as is known."""
        return next((value for begin, value in reversed(self._pending) if begin < instant), self.value)

    def segments(self, begin: int, end: int) -> Iterator[Segment]:
        """Cut [begin, end) where commands act; a command that should have acted earlier acts at `begin`."""
        while self._pending and self._pending[0][0] < end:
            apply_at, value = self._pending.popleft()
            if apply_at > begin:
                yield Segment(begin, apply_at, self.value)
                begin = apply_at
            self.value, self.since = value, apply_at
        yield Segment(begin, end, self.value)
