"""Does the twin agree with the theory of the amplitude? Its own edge after each step, searched in the interval."""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from bridge.scenario import Scenario
from bridge.studies.stability.advice import StepAdvice
from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.twin_edge import SCAN, step_edge
from controller.stability.amplitude.edges import Edge

BEYOND = 1.1  # times the upper end, how far is searched
OPEN = 4.0  # times the lower end, where there is no upper one


class Verified(NamedTuple):
    """The edge of the twin beside the interval of one step, gains in the unit of the free gain."""

    size: float  # of the step [m]
    low: float
    high: float  # inf: swings at no gain
    found: Edge  # of the twin; swings inf: at no gain that was tried

    @property
    def agrees(self) -> bool:
        """Does the twin begin to swing within the interval? Without an upper end: not below it."""
        return self.low <= self.found.swings and self.found.settles <= self.high and self._ends

    @property
    def _ends(self) -> bool:
        return math.isfinite(self.found.swings) or math.isinf(self.high)

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return self._asdict() | {"found": self.found._asdict(), "agrees": self.agrees}


def verified(scenario: Scenario, steps: tuple[StepAdvice, ...]) -> Iterator[Verified]:
    """The twin's edge of each step that has an interval, one after another."""
    for step in steps:
        low, high = step.settles_below.volts, step.swings_above.volts
        if low is not None:
            yield compared(scenario, step.size, low, math.inf if high is None else high)


def compared(scenario: Scenario, size: float, low: float, high: float) -> Verified:
    """The edge after a step of a size [m], searched from its interval's lower end to beyond the upper one."""
    unit = free_gain(scenario).per_unit
    furthest = BEYOND * high / low if math.isfinite(high) else OPEN
    found = step_edge(scenario, size, low * unit, SCAN._replace(up=furthest))
    in_unit = found._replace(settles=found.settles / unit, swings=found.swings / unit)
    return Verified(size, low, high, in_unit)
