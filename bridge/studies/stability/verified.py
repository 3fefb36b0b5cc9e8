"""Does the twin agree with the theory of the amplitude? Its own edge after each step, searched in the interval."""

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from bridge.scenario import Scenario
from bridge.studies.stability.advised import StepAdvice
from bridge.studies.stability.probe import stand_of
from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.trial import trial
from bridge.studies.stability.twin_edge import SCAN, step_edge, stepped
from controller.stability.amplitude.edges import Edge
from controller.stability.amplitude.swing import Swing, last_third

BEYOND = 1.1  # times the upper end, how far is searched
SIZE_RATIO, FREQUENCY_RATIO = 1.3, 1.2  # of a cycle, predicted and found
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


class VerifiedCycle(NamedTuple):
    """The twin under a law without a gain, beside what was predicted for one step."""

    size: float  # of the step [m]
    peak_to_peak: float  # predicted [m]
    frequency: float  # predicted [Hz]; 0.0: irregular
    found: Swing  # of the twin

    @property
    def agrees(self) -> bool:
        """Peak to peak within SIZE_RATIO, and the frequency within FREQUENCY_RATIO where both have one."""
        often = self.frequency and self.found.frequency
        near = not often or _within(self.frequency, self.found.frequency, FREQUENCY_RATIO)
        return near and _within(self.peak_to_peak, self.found.peak_to_peak, SIZE_RATIO)

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return self._asdict() | {"found": self.found._asdict(), "agrees": self.agrees}


def verified_cycles(scenario: Scenario, cycles: Sequence[tuple[float, float, float]]) -> Iterator[VerifiedCycle]:
    """The twin after each step, one after another."""
    for size, peak, often in cycles:
        trace = trial(stepped(scenario, size), stand_of(scenario))
        yield VerifiedCycle(size, peak, often, last_third(trace.time, trace.position))


def _within(one: float, other: float, ratio: float) -> bool:
    return max(one, other) <= ratio * min(one, other)
