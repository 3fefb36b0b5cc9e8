"""Where a run stands among the stable gains of its own loop, and whether it swung as the theory says."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.scenario import Scenario, ScenarioError
from bridge.scenario.gains import gains
from bridge.studies.stability.advice import Stability, plants_of, verdict
from bridge.studies.stability.rig_loop import (
    edge_of,
    loop_of,
    named,
    timing_of,
)
from controller.bands import Metrics
from controller.law import volts_per_percent
from controller.stability import closed, dominant, is_stable, loop_onset

ROUND = (0.2, 5.0)  # of the own sampling interval, what the chart spans
PLACES = 15
LONGEST = 40  # sampling periods of delay; the work grows with the cube, seconds here, minutes at 100


class PointStability(NamedTuple):
    """The loop about one point of rest or slow motion."""

    critical_gain: float  # [V/%]
    frequency: float  # [Hz], of the oscillation that starts there
    stable: bool  # at the gains of the run
    swing_frequency: float  # [Hz], of the dominant motion at those


class OperatingPoint(NamedTuple):
    """Where a run stands among the stable gains, and what it did."""

    gain: float  # [V/%]
    sample_period: float  # [s]
    delay: float  # [s]
    verdict: Stability
    points: dict[str, PointStability]  # by the name of the point: rest, up, down
    found_frequency: float | None  # [Hz], of the run's own limit cycle; 0.0: none; None: not known
    found_amplitude: float | None  # [m]

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return self._asdict() | {"points": {name: point._asdict() for name, point in self.points.items()}}


def operating_point(scenario: Scenario, metrics: Metrics | None) -> OperatingPoint | None:
    """None for a loop that the theory does not know, and where it is left out."""
    if left_out(scenario):
        return None
    try:
        found = plants_of(scenario)
    except ScenarioError:
        return None
    own, timing = gains(scenario), timing_of(scenario)
    points = {}
    for name, point in found.items():
        loop = loop_of(point.plant(), timing)
        edge = named(loop_onset(loop, own.derivative), timing)
        points[name] = PointStability(
            critical_gain=_volts(edge.gain, scenario),
            frequency=edge.frequency,
            stable=bool(is_stable(closed(loop, own.proportional, own.derivative))),
            swing_frequency=named(dominant(loop, own.proportional, own.derivative), timing).frequency,
        )
    return OperatingPoint(
        gain=_volts(own.proportional, scenario),
        sample_period=timing.period,
        delay=timing.delay,
        verdict=verdict([point.stable for point in points.values()]),
        points=points,
        found_frequency=_known(metrics.limit_cycle_frequency) if metrics else None,
        found_amplitude=_known(metrics.limit_cycle_amplitude) if metrics else None,
    )


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def left_out(scenario: Scenario) -> str | None:
    """Why a run is not compared with the theory, in words; None for a run that is."""
    if scenario.controller.kind != "pd":
        return None
    timing = timing_of(scenario)
    if _periods(timing.delay, timing.period) <= LONGEST:
        return None
    return (
        f"the linear theory was left out: loop.delay {timing.delay:g} s is more than {LONGEST} sampling periods of "
        f"{timing.period:g} s, which takes minutes; `hydrotwin advise` computes it"
    )


def _periods(delay: float, period: float) -> int:
    return math.ceil(round(delay / period, 9))


def sentences(at: OperatingPoint) -> list[str]:
    """An operating point in words."""
    criticals = [point.critical_gain for point in at.points.values()]
    predicted = [point.swing_frequency for point in at.points.values() if not point.stable]
    lines = [
        f"{at.gain:.3g} V/% at {at.sample_period * 1e3:g} ms and {at.delay * 1e3:g} ms delay; critical "
        f"{_stretch(criticals)} V/% by the linear theory: {at.verdict.words}"
    ]
    found, amplitude = at.found_frequency, at.found_amplitude
    swing = f"{found:.3g} Hz, {amplitude * 1e3:.3g} mm" if found and amplitude is not None else "none"
    swing = "not applicable, no constant stretch to judge" if found is None else swing
    expected = f"{_stretch(predicted)} Hz" if predicted else "none"
    return [*lines, f"oscillation predicted: {expected}; found: {swing}"]


def _stretch(values: Sequence[float]) -> str:
    low, high = f"{min(values):.3g}", f"{max(values):.3g}"
    return low if low == high else f"{low} to {high}"


def edge_curves(scenario: Scenario) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sampling intervals [s] around the run's own, and the least and greatest critical gain [V/%] at each, (n, 2)."""
    found, own, timing = plants_of(scenario), gains(scenario), timing_of(scenario)
    intervals = timing.period * np.geomspace(*ROUND, PLACES)
    intervals = intervals[[_periods(timing.delay, t) <= LONGEST for t in intervals.tolist()]]
    rows = [
        [edge_of(point.plant(), timing._replace(period=t), own.derivative).gain for point in found.values()]
        for t in intervals.tolist()
    ]
    return intervals, np.array([[_volts(min(row), scenario), _volts(max(row), scenario)] for row in rows])


def _volts(gain: float, scenario: Scenario) -> float:
    return volts_per_percent(gain, scenario.rig.cylinder.stroke, scenario.rig.valve.full_scale)
