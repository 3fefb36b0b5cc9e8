"""Does the twin agree with the theory of the amplitude? It runs at both ends of each step's interval."""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from bridge.scenario import Scenario
from bridge.studies.stability.advice import StepAdvice
from bridge.studies.stability.sampled_law import FreeGain, free_gain
from bridge.studies.stability.twin_edge import twin_swing
from controller.stability.amplitude.swing import Swing


class Verified(NamedTuple):
    """One run of the twin at an end of an interval."""

    size: float  # of the step [m]
    gain: float  # in the unit of the free gain
    expected: bool  # does it swing, by the theory?
    found: Swing

    @property
    def agrees(self) -> bool:
        """Does the twin do what the theory says?"""
        return self.found.counts == self.expected

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return self._asdict() | {"found": self.found._asdict(), "agrees": self.agrees}


def verified(scenario: Scenario, steps: tuple[StepAdvice, ...]) -> Iterator[Verified]:
    """The twin at the ends of each interval, one run after another."""
    free: FreeGain = free_gain(scenario)
    for step in steps:
        for end, expected in ((step.settles_below, False), (step.swings_above, True)):
            if end.volts is not None and math.isfinite(end.volts):
                found = twin_swing(scenario, end.volts * free.per_unit, step.size)
                yield Verified(step.size, end.volts, expected, found)
