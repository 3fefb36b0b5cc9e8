"""When which message of a replay is due: an anchor in both times and a speed, anew at every change of either.

Pure: `now` is handed in [ns of wall time]; the times of the messages are sorted, and equal ones keep their order.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Sequence

MOST = 64  # messages at a time when nothing paces them


class Timeline:
    """Where a replay stands."""

    def __init__(self, times: Sequence[int], now: int, speed: float = 1.0, loop: bool = False) -> None:
        self.times = times
        self.index = 0  # of the next message
        self.speed = speed  # recorded over wall time; infinite: as fast as it goes
        self.paused = False
        self.loop = loop
        self.loops = 0  # ended
        self._anchor = (now, times[0] if times else 0)  # wall time, recorded time

    @property
    def ended(self) -> bool:
        """Is nothing left?"""
        return self.index >= len(self.times)

    def time(self, now: int) -> int:
        """Recorded time reached [ns]."""
        wall, recorded = self._anchor
        if self.paused or math.isinf(self.speed):
            return recorded
        reached = recorded + round((now - wall) * self.speed)
        return min(reached, self.times[-1]) if self.times else reached

    def due(self, now: int) -> int | None:
        """Wall time at which the next message is due; None when none is."""
        if self.paused or self.ended:
            return None
        if math.isinf(self.speed):
            return now
        wall, recorded = self._anchor
        return wall + math.ceil((self.times[self.index] - recorded) / self.speed)

    def take(self, now: int) -> range:
        """The messages that are due, all of an instant together; they count as sent."""
        if math.isinf(self.speed):
            last = min(self.index + MOST, len(self.times))
        else:
            last = bisect_right(self.times, self.time(now), self.index)
        taken = range(self.index, last)
        self._advance(last, now)
        return taken

    def step(self, now: int) -> range:
        """The messages of the next instant; then, as before, nothing until asked."""
        self.pause(now)
        if self.ended:
            return range(0)
        last = bisect_right(self.times, self.times[self.index], self.index)
        taken = range(self.index, last)
        self._anchor = (now, self.times[self.index])
        self._advance(last, now)
        return taken

    def pause(self, now: int) -> None:
        """Stand still."""
        self._anchor = (now, self.time(now))
        self.paused = True

    def resume(self, now: int) -> None:
        """Go on from where it stands."""
        self._anchor = (now, self.time(now))
        self.paused = False

    def set_speed(self, speed: float, now: int) -> None:
        """Change the speed from here on. Raises ValueError for one that is not above zero."""
        if not speed > 0.0:
            raise ValueError(f"speed {speed:g} must be greater than 0; to stand still there is pause")
        self._anchor = (now, self.time(now))
        self.speed = speed

    def seek(self, time: int, now: int) -> None:
        """Go on from a recorded time [ns]; next comes the first message at or after it."""
        inside = min(max(time, self.times[0]), self.times[-1])
        self.index = bisect_left(self.times, inside)
        self._anchor = (now, inside)

    def _advance(self, last: int, now: int) -> None:
        if math.isinf(self.speed) and last > self.index:
            self._anchor = (now, self.times[last - 1])
        self.index = last
        if self.loop and self.ended and self.times:
            self.loops += 1
            self.seek(self.times[0], now)
