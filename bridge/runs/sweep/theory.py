"""The gain at which the linear theory of the sampled loop says that a swing begins, beside the runs of a sweep."""

import math
from typing import NamedTuple

from bridge.errors import UsageError
from bridge.runs.sweep.axes import Axis
from bridge.runs.sweep.sweep import Wanted
from bridge.scenario import Scenario, changed
from bridge.scenario.controllers import Pd
from controller.law import volts_per_percent

GAIN, TIMES = "controller.gain", ("loop.delay", "loop.sample_period")
MOST = 60  # values along the other axis at which the edge is computed


class TheoryEdge(NamedTuple):
    """The critical gain, along the other axis if there is one."""

    about: str  # point of the rig
    gain: int  # which axis it is on
    places: list[float]  # on the other axis, in its unit; empty without one
    gains: list[float]  # in the unit of the axis of the gain; NaN: none

    @property
    def words(self) -> str:
        """What the line is."""
        return f"critical gain by linear theory, about the point {self.about!r}"


def theory_edge(wanted: Wanted) -> TheoryEdge | None:
    """The edge, where the sweep is one over the gain of a PD controller, alone or with a time of its loop."""
    names = [axis.name for axis in wanted.axes]
    others = [axis for axis in wanted.axes if axis.name != GAIN]
    if GAIN not in names or len(others) > 1 or not isinstance(wanted.scenario.controller, Pd):
        return None
    gain = wanted.axes[names.index(GAIN)]
    if gain.numbers is None or (others and (others[0].name not in TIMES or others[0].numbers is None)):
        return None
    return _edge(wanted.scenario, gain, others[0] if others else None, names.index(GAIN))


def _edge(scenario: Scenario, gain: Axis, other: Axis | None, index: int) -> TheoryEdge | None:
    from bridge.studies.stability.advice import plants_of

    try:
        name, point = next(iter(plants_of(scenario).items()))
    except (UsageError, ValueError):
        return None  # the loop has no linear theory
    if other is None or other.numbers is None:
        return TheoryEdge(name, index, [], [_critical(scenario, point, gain)])
    numbered = sorted(zip(other.numbers, range(len(other.numbers)), strict=True))
    step = math.ceil(len(numbered) / MOST)
    chosen = numbered[::step]
    base = scenario.model_dump(mode="json")
    gains = []
    for _, place in chosen:
        try:
            gains.append(_critical(changed(base, [other.change(place)], scenario.name), point, gain))
        except UsageError:
            gains.append(math.nan)
    return TheoryEdge(name, index, [number for number, _ in chosen], gains)


def _critical(scenario: Scenario, point: object, gain: Axis) -> float:
    """In the unit of the axis; NaN where there is none, or the delay is too long to ask."""
    from bridge.scenario.gains import gains
    from bridge.studies.stability.advice import LONGEST
    from bridge.studies.stability.rig_loop import edge_of, timing_of
    from bridge.studies.stability.rig_plant import RigPlant

    assert isinstance(point, RigPlant)
    timing = timing_of(scenario)
    if timing.delay > LONGEST * timing.period:
        return math.nan
    found = edge_of(point.plant(), timing, gains(scenario).derivative).gain
    if not math.isfinite(found) or found <= 0.0:
        return math.nan
    rig = scenario.rig
    return found if gain.unit == "1/m" else volts_per_percent(found, rig.cylinder.stroke, rig.valve.full_scale)
