"""Faults between the card's output and the spool: what the valve makes of a command."""

import math
from collections.abc import Callable

from bridge.loop.fault_clock import Spell
from bridge.loop.spells import Spells

Faulty = Callable[[float], float]  # of a spool reference, -1 .. 1


class ValveFaults:
    """Faults of one valve; each acts on what those before it in the scenario leave."""

    def __init__(self, power_off: float) -> None:
        """power_off: where the spool goes without power, share of the travel."""
        self._power_off = power_off
        self._spells: Spells[Faulty] = Spells()

    def start(self, spell: Spell) -> None:
        """A fault of the valve is going to be there."""
        self._spells.add(spell, self._made(spell))

    def end(self, name: str, now: int) -> None:
        """End a fault of the valve at an instant [ns]."""
        self._spells.end(name, now)

    def next(self, now: int) -> int | None:
        """The next instant at which one begins or ends [ns]."""
        return self._spells.next(now)

    def reference(self, given: float, now: int) -> float:
        """What the spool is after, of what it is given at an instant [ns]."""
        for _, faulty in self._spells.there(now):
            given = min(1.0, max(-1.0, faulty(given)))
        return given

    def _made(self, spell: Spell) -> Faulty:
        sizes = spell.fault.sizes
        if spell.fault.kind == "power-loss":
            return lambda given: self._power_off
        if spell.fault.kind == "hysteresis":
            return _play(0.5 * sizes["width"])
        return PLAIN[spell.fault.kind](sizes)


def _play(half: float) -> Faulty:
    """Backlash: the output follows an edge of the play that the input has reached."""
    last: list[float] = []

    def faulty(given: float) -> float:
        if not last:
            last.append(given)
        last[0] = min(max(last[0], given - half), given + half)
        return last[0]

    return faulty


PLAIN: dict[str, Callable[[dict[str, float]], Faulty]] = {
    "dead-band": lambda sizes: lambda given: math.copysign(max(0.0, abs(given) - sizes["width"]), given),
    "bias": lambda sizes: lambda given: given + sizes["size"],
    "saturated": lambda sizes: lambda given: min(sizes["limit"], max(-sizes["limit"], given)),
    "reversed": lambda sizes: lambda given: -given,
}
