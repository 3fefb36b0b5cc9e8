"""Twins that run freely beside a rig, a short shot at a time, each with unknowns of its own: how far is each from it?

A shot begins at the mean of an estimate. The pressures that the card reads are put where it has read them, so that a
twin with an offset of a transducer begins at another pressure; waves and flows that nothing tells die out before the
shot counts. As in multiple shooting (H. G. Bock 1981) nothing corrects a twin on its way, so that a wrong number shows.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.circuit.block import compiled
from twin.circuit.state import ENDS_AT
from twin.estimation.admissible import admit
from twin.estimation.filter import Filter
from twin.estimation.members import Members
from twin.estimation.quantities import LEAKS_OUTSIDE, UNKNOWNS, Use
from twin.estimation.unknowns import Unknowns, value_of
from twin.kernel import entry
from twin.topology import CHANNELS, END_OF, TAPS

Array = NDArray[np.float64]
SHOT, DEAD = 0.5, 0.1  # [s], how long one is, and of it what does not count
UNREAD = (Use.MISSING, Use.SPIKE, Use.STUCK)  # a channel that is off by a fault of the rig tells of the fault


class Shots:
    """Of one estimate, which is advanced and corrected by others; its members must be there."""

    def __init__(self, estimate: Filter, names: Sequence[str], z: Array) -> None:
        """names: of the unknowns, those of the estimate first; z: a row for each twin."""
        assert estimate.members is not None
        self._estimate = estimate
        self._unknowns = Unknowns(estimate.circuit.parts, names, len(z))
        self._unknowns.write(z)
        states = np.repeat(estimate.members.states[:1], len(z), axis=0)
        self._members = Members(estimate.circuit, self._unknowns, states)
        lines = compiled(estimate.circuit)
        self._admitted: Any = self._unknowns.records, lines.whole, lines.numbers, states
        self._admit = entry(admit, *self._admitted)
        self._age = 0.0

    @property
    def over(self) -> bool:
        """Is the shot at its end?"""
        return self._age >= SHOT - 1e-9

    def begin(self, z: Array | None = None) -> None:
        """A shot, at the estimate; z: other unknowns than before."""
        if z is not None:
            self._unknowns.write(z)
        estimate, states = self._estimate, self._members.states
        assert estimate.members is not None
        states[:] = estimate.members.states.mean(axis=0)
        offsets = estimate.unknowns.offsets.mean(axis=0) - self._unknowns.offsets
        for channel, place in TAPS.items():
            states[:, ENDS_AT + END_OF[place]] += offsets[:, [*CHANNELS].index(channel)]
        self._admit(*self._admitted)
        self._members.run(0.0, 0)
        self._age = 0.0

    def advance(self, reference: float, steps: int) -> None:
        """Move on under a spool reference."""
        if steps:
            self._members.run(reference, steps)
            self._age += steps * self._estimate.circuit.parts.step

    def look(self, readings: Mapping[str, float]) -> Array | None:
        """Readings less what the card would read of each twin, twins x channels; NaN where nothing is read.

        None while the shot does not count. The estimate must have looked before.
        """
        if self._age <= DEAD:
            return None
        read = np.array([np.nan if self._unread(name) else readings[name] for name in CHANNELS])
        return read - self._estimate.sensors.predicted(self._members.taps, self._unknowns.offsets)

    def _unread(self, channel: str) -> bool:
        estimate = self._estimate
        return channel in estimate.settings.without or estimate.watches[channel].use in UNREAD


def known_to(estimate: Filter) -> tuple[str, ...]:
    """Unknowns of the shots beside an estimate: its own, and leaks to the outside where its circuit can have them."""
    parts = estimate.circuit.parts
    return (*estimate.names, *(name for name in LEAKS_OUTSIDE if value_of(parts, UNKNOWNS[name].fields[0])))
