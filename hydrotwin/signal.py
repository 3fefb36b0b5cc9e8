"""A signal of a run, and what a test says of it."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.scenario.units import UNITS, quantity, shown

Quantity = float | str  # a number in SI, or a text with a unit


class Signal(NamedTuple):
    """One quantity over time."""

    name: str
    unit: str  # SI
    time: NDArray[np.float64]  # [s]
    value: NDArray[np.float64]

    def part(self, after: Quantity | None = None, before: Quantity | None = None) -> "Signal":
        """What lies between two times [s], both included. Raises ValueError where nothing does."""
        begin = -math.inf if after is None else quantity(after, "s")
        end = math.inf if before is None else quantity(before, "s")
        inside = (self.time >= begin - 1e-9) & (self.time <= end + 1e-9)
        if not inside.any():
            raise ValueError(f"{self.name}: nothing from {begin:g} s to {end:g} s; it lasts to {self.time[-1]:g} s")
        return self._replace(time=self.time[inside], value=self.value[inside])

    def stays(
        self,
        below: Quantity | None = None,
        above: Quantity | None = None,
        after: Quantity | None = None,
        before: Quantity | None = None,
    ) -> "Signal":
        """The signal, which is nowhere beyond its limits, the limits included. AssertionError with the worst value."""
        part = self.part(after, before)
        for limit, sign, word in ((below, 1.0, "below"), (above, -1.0, "above")):
            if limit is None:
                continue
            beyond = sign * (part.value - self._number(limit))
            if not np.all(beyond <= 0.0):  # NaN is not within either
                worst = int(np.argmax(np.where(np.isnan(beyond), math.inf, beyond)))
                raise AssertionError(
                    f"{self.name} does not stay {word} {self.words(self._number(limit))}: "
                    f"it is {self.words(part.value[worst])} at {part.time[worst]:g} s"
                )
        return self

    def reaches(
        self,
        above: Quantity | None = None,
        below: Quantity | None = None,
        after: Quantity | None = None,
        before: Quantity | None = None,
    ) -> float:
        """When [s] it is first beyond a limit. AssertionError with how near it comes."""
        part = self.part(after, before)
        limit, sign, word = (above, 1.0, "above") if below is None else (below, -1.0, "below")
        if limit is None:
            raise ValueError("say what it reaches: above=... or below=...")
        beyond = sign * (part.value - self._number(limit)) > 0.0
        if not beyond.any():
            nearest = part.value[int(np.nanargmax(sign * part.value))]
            raise AssertionError(
                f"{self.name} is never {word} {self.words(self._number(limit))}; it comes to {self.words(nearest)}"
            )
        return float(part.time[int(np.argmax(beyond))])

    def settles(
        self, at: Quantity, within: Quantity, after: Quantity | None = None, before: Quantity | None = None
    ) -> float:
        """From when on [s] it stays within so much of a value. AssertionError where that is later than `before`."""
        part = self.part(after)
        target, band = self._number(at), self._number(within)
        outside = np.flatnonzero(~(np.abs(part.value - target) <= band))
        settled = 0 if not outside.size else int(outside[-1]) + 1
        limit = math.inf if before is None else quantity(before, "s")
        if settled == len(part.time) or part.time[settled] > limit + 1e-9:
            last = int(outside[-1])
            raise AssertionError(
                f"{self.name} does not settle at {self.words(target)} within {self.words(band)}"
                f"{'' if before is None else f' before {limit:g} s'}: "
                f"it is {self.words(part.value[last])} at {part.time[last]:g} s, "
                f"{self.words(abs(part.value[last] - target))} away"
            )
        return float(part.time[settled])

    def words(self, value: float) -> str:
        """A value as people read it."""
        factor, unit = shown(self.unit)
        return f"{value * factor:.4g} {unit}".rstrip()

    def _number(self, value: Any) -> float:
        return quantity(value, self.unit if self.unit in UNITS else "")
