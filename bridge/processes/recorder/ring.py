"""Keep the last seconds in memory, and let them through when something happens: so much before it, so much after."""

from collections import deque
from collections.abc import Iterator
from typing import NamedTuple


class Window(NamedTuple):
    """What is kept of an event [ns of simulated time]."""

    before: int
    after: int


class Ring:
    """Messages in the order of their coming; holds back all that no trigger has asked for."""

    def __init__(self, window: Window) -> None:
        self.window = window
        self.triggers = 0
        self._kept: deque[tuple[str, int, int, bytes]] = deque()
        self._open_until = -1  # log time up to which messages go straight through
        self._open_from = 0  # log time from which on
        self._now = 0

    @property
    def open(self) -> bool:
        """Do messages go straight through now?"""
        return self._now <= self._open_until

    def trigger(self, time: int) -> None:
        """Something happened at a time [ns]: what is kept goes out with the next message."""
        self.triggers += 1
        if not self.open:
            self._open_from = time - self.window.before
        self._open_until = max(self._open_until, time + self.window.after)

    def add(self, topic: str, log_time: int, sequence: int, payload: bytes) -> Iterator[tuple[str, int, int, bytes]]:
        """Take a message; gives those to be written now."""
        self._now = max(self._now, log_time)
        self._kept.append((topic, log_time, sequence, payload))
        while self._kept and self._kept[0][1] < self._now - self.window.before:
            self._kept.popleft()
        if self.open:
            yield from self.drain()

    def drain(self) -> Iterator[tuple[str, int, int, bytes]]:
        """Give out all that is kept, but what is too old: a trigger may be known before messages of its time come."""
        while self._kept:
            message = self._kept.popleft()
            if message[1] >= self._open_from:
                yield message
