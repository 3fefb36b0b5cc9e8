"""A reference that somebody moves while the loop runs: limited, ramped, and held when nobody is heard any more."""

from typing import NamedTuple

from bridge.scenario.references import Live
from controller.grid import to_ns


class Aim(NamedTuple):
    """Where the reference is to go."""

    position: float  # [m]
    over: int  # [ns]; 0: at once


class LiveReference:
    """Turns targets into changes of the reference."""

    def __init__(self, live: Live) -> None:
        self._live = live
        self._timeout = to_ns(live.timeout)
        self._wanted = live.value
        self._heard: int | None = None  # when, while the reference moves [ns]
        self._there = 0  # when it arrives [ns]

    def aim(self, target: float | None, now: int, position: float) -> Aim | None:
        """What to change, if anything; position: of the reference now [m]."""
        if target is not None:
            self._heard = now
            wanted = min(max(target, self._live.low), self._live.high)
            if wanted != self._wanted:
                return self._go(wanted, position, now)
        elif self._heard is not None and now - self._heard > self._timeout:
            self._heard = None
            if now < self._there:
                self._wanted, self._there = position, now
                return Aim(position, 0)
        return None

    def _go(self, wanted: float, position: float, now: int) -> Aim:
        over = to_ns(abs(wanted - position) / self._live.rate)
        self._wanted, self._there = wanted, now + over
        return Aim(wanted, over)
