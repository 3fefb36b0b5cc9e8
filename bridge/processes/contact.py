"""Whether the plant is still there for those that work with it, and what it means when it is not."""

import time
from collections.abc import Callable
from typing import Any

from bridge.errors import RunError
from bridge.wire.bus import Bus
from bridge.wire.messages import GOING
from bridge.wire.status import PlantStatus, numbers_of

RECONNECTING = 10.0  # seconds that a router may be gone: sessions connect again by themselves
DIRECT = 1.0  # seconds where the plant itself is what was connected to
FAREWELL = 2.0  # seconds after the plant's end in which its last measurements may still come
REPLAY = "replay"  # how a replay that stands in for a plant calls itself


def is_farewell(status: Any) -> bool:
    """Is it the last word of a replay? It comes behind all that the replay has sent."""
    return status.role == REPLAY and status.phase not in GOING


class Contact:
    """Follows the plants on a bus."""

    def __init__(self, bus: Bus, is_expected: bool = False, now: Callable[[], float] = time.monotonic) -> None:
        """is_expected: has a plant answered, so that one that is never seen has gone? Else it is waited for."""
        self._bus = bus
        self._now = now
        self._patience = RECONNECTING if list(bus.session.info.routers_zid()) else DIRECT
        self._is_expected = is_expected
        self._gone_since: float | None = None
        self._last: set[str] = set()
        self._farewell = False  # of a replay: behind all that it has sent
        self._last_tick: int | None = None  # of the plant, once it has said so
        self._deadline = float("inf")

    def lost(self) -> bool:
        """Has the plant been away for longer than it takes to connect again, or has a replay taken its leave?

        That a replay is away is known before its last messages are here: Zenoh lets such news overtake them.
        """
        here = self._bus.present.get("plant")
        if here or (here is None and not self._is_expected):
            self._farewell = self._farewell and self._gone_since is None  # another replay takes its own leave
            self._last, self._gone_since = set(here or ()), None
            return False
        if self._gone_since is None:
            self._gone_since = self._now()
        patience = RECONNECTING if here is None else self._patience  # it may be about to declare its token
        return (self._last == {REPLAY} and self._farewell) or self._now() - self._gone_since > patience

    def hear(self) -> None:
        """Something has come from a plant: one that is never seen, since it declares no token, is there."""
        if self._bus.present.get("plant") is None:
            self._gone_since = None

    def words(self, when: str) -> str | None:
        """What a loss means, in one line; None where the plant was a replay, which may leave at any time."""
        if self._last == {REPLAY}:
            return None
        return f"lost contact with the plant at {when}: it was killed, or the connection to it was lost"

    def heed(self, status: Any) -> None:
        """Take a status of anybody: the plant's last one says which tick was its last, a replay's that it is over."""
        self._farewell = self._farewell or is_farewell(status)
        if status.role == "plant" and status.phase not in GOING:
            self._last_tick = PlantStatus.from_plain(numbers_of(status)).tick
            self._deadline = self._now() + FAREWELL

    def over(self, tick: int, when: str) -> bool:
        """Has the plant ended, and has its last tick been dealt with? Raises RunError where it is lost."""
        if self._last_tick is not None:
            return tick >= self._last_tick or self._now() > self._deadline
        if not self.lost():
            return False
        if words := self.words(when):
            raise RunError(words)
        return True
