"""A stable order for what several publishers send: (log_time, channel, sequence).

Messages wait until nothing earlier can come any more. The plant's go out per tick, so a measurement of a later tick
closes the ticks before; a command of a later sample what its controller said before.
"""

import heapq
from collections.abc import Iterator

from controller.grid import Sampling

ALWAYS = 1 << 62
Ordered = tuple[str, int, int, bytes]  # topic, log time, sequence, payload


class Order:
    """Sorts messages by (log_time, channel, sequence) as they become safe to write."""

    def __init__(self, grid: Sampling) -> None:
        self._heap: list[tuple[int, str, int, bytes]] = []
        self._plant = 0  # nothing of the plant's before this [ns] is still to come
        self._controller = grid.offset  # the same for the controller's

    def add(self, topic: str, log_time: int, sequence: int, payload: bytes) -> Iterator[Ordered]:
        """Take a message and give back those that are now in order."""
        heapq.heappush(self._heap, (log_time, topic, sequence, payload))
        if topic == "measurement":
            self._plant = log_time
        elif topic == "command":
            self._controller = max(self._controller, log_time)
        return self._before(min(self._plant, self._controller))

    def rest(self) -> Iterator[Ordered]:
        """What is left at the end."""
        return self._before(ALWAYS)

    def _before(self, time: int) -> Iterator[Ordered]:
        while self._heap and self._heap[0][0] < time:
            log_time, topic, sequence, payload = heapq.heappop(self._heap)
            yield topic, log_time, sequence, payload
