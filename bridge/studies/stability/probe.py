"""Asking the twin at which gain it begins to oscillate: a held piston, a small step, bisection in the gain."""

import math
from typing import Any, NamedTuple

from bridge.scenario import Scenario
from bridge.scenario.controllers import StateSpace
from bridge.scenario.references import Step
from bridge.studies.stability.criterion import Swing, duration, judge_swing
from bridge.studies.stability.sampled_law import at_gain, scaled_matrices
from bridge.studies.stability.trial import (
    Stand,
    Trace,
    stand,
    trial,
)

STEP = 2e-3  # [m], of the reference
AT = 0.1  # [s], when it steps, at the sampling instant that follows
TOLERANCE = 0.01  # of the gain


class TwinEdge(NamedTuple):
    """Where a loop begins to oscillate."""

    stable: float  # [1/m], the highest gain found that does not oscillate
    unstable: float  # [1/m], the lowest found that does
    frequency: float  # [Hz], there
    amplitude: float  # [m], there

    @property
    def critical(self) -> float:
        """The gain between both [1/m]."""
        return math.sqrt(self.stable * self.unstable)


def probe(scenario: Scenario, gain: float, size: float = STEP) -> Scenario:
    """The scenario as a trial at a gain [1/m], of matrices a factor: held, then stepped by `size`."""
    interval = scenario.loop.sample_period
    at = interval * math.ceil(max(AT, scenario.loop.delay) / interval)
    held = scenario.start.position
    reference = Step(kind="step", start=held, end=held + size, at=at)
    update: dict[str, Any] = {"reference": reference, "duration": duration(at, interval)}
    changed = scaled_matrices if isinstance(scenario.controller, StateSpace) else at_gain
    return changed(scenario, gain).model_copy(update=update)


def swing_at(scenario: Scenario, gain: float, size: float, on: Stand) -> Swing:
    """Run the trial and judge it."""
    asked = probe(scenario, gain, size)
    return judged(trial(asked, on), asked, size)


def judged(trace: Trace, asked: Scenario, size: float) -> Swing:
    """The swing of a trial's trace."""
    reference: Any = asked.reference
    return judge_swing(trace.time, trace.position, reference.at, size, not asked.daq.quantise)


def critical_gain(scenario: Scenario, guess: float, size: float = STEP, tolerance: float = TOLERANCE) -> TwinEdge:
    """The gain [1/m] at which the twin begins to oscillate, bracketed from a guess, then bisected to the tolerance.

    Raises ValueError when neither 1/64 nor 64 times the guess brackets it.
    """
    on = stand_of(scenario)
    low, high = 0.8 * guess, 1.25 * guess
    found = swing_at(scenario, high, size, on)
    while not found.oscillates:
        low, high = high, high * 1.6
        if high > 64.0 * guess:
            raise ValueError(f"the loop does not oscillate up to a gain of {high:.4g} 1/m, 64 times the guess")
        found = swing_at(scenario, high, size, on)
    while (lower := swing_at(scenario, low, size, on)).oscillates:
        high, low, found = low, low / 1.6, lower
        if low < guess / 64.0:
            raise ValueError(f"the loop oscillates down to a gain of {low:.4g} 1/m, 1/64 of the guess")
    while high > low * (1.0 + tolerance):
        between = math.sqrt(low * high)
        swing = swing_at(scenario, between, size, on)
        if swing.oscillates:
            high, found = between, swing
        else:
            low = between
    return TwinEdge(low, high, found.frequency, found.amplitude)


def stand_of(scenario: Scenario) -> Stand:
    """The scenario's stand; the last few are kept, so that a sweep over loop and gains builds each rig once."""
    key = f"{scenario.rig!r} {scenario.start!r} {scenario.loop.step!r}"
    if key not in _STANDS:
        while len(_STANDS) >= STANDS:
            del _STANDS[next(iter(_STANDS))]
        _STANDS[key] = stand(scenario)
    return _STANDS[key]


STANDS = 8
_STANDS: dict[str, Stand] = {}
