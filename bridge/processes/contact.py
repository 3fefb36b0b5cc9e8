"""Whether the plant is still there for those that work with it, and what it means when it is not."""

import time
from collections.abc import Callable

from bridge.wire.bus import Bus

RECONNECTING = 10.0  # seconds that a router may be gone: sessions connect again by themselves
DIRECT = 1.0  # seconds where the plant itself is what was connected to
REPLAY = "replay"  # how a replay that stands in for a plant calls itself


class Contact:
    """Follows the plants on a bus."""

    def __init__(self, bus: Bus, now: Callable[[], float] = time.monotonic) -> None:
        self._bus = bus
        self._now = now
        self._patience = RECONNECTING if list(bus.session.info.routers_zid()) else DIRECT
        self._gone_since: float | None = None
        self._last: set[str] = set()

    def lost(self) -> bool:
        """Has the plant been away for longer than it takes to connect again?"""
        here = self._bus.present.get("plant")
        if here is None or here:
            self._last, self._gone_since = set(here or ()), None
            return False
        if self._gone_since is None:
            self._gone_since = self._now()
        return self._last == {REPLAY} or self._now() - self._gone_since > self._patience

    def words(self, when: str) -> str | None:
        """What a loss means, in one line; None where the plant was a replay, which may leave at any time."""
        if self._last == {REPLAY}:
            return None
        return f"lost contact with the plant at {when}: it was killed, or the connection to it was lost"
