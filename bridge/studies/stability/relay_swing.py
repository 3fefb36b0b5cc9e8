"""How a relay's loop on a rig swings, over its sampling period, delay and derivative time.

Predicted by the reduced drive (`controller.stability.amplitude`), found on the twin; both after one small step, by the
last third of a run.
"""

import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from bridge.scenario import Scenario, changed
from bridge.studies.stability.amplitude import loop_of
from bridge.studies.stability.probe import stand_of
from bridge.studies.stability.relay_lead import relay_of
from bridge.studies.stability.trial import trial
from bridge.studies.stability.twin_edge import AT, stepped
from bridge.studies.sweep.engine import Crew, sweep
from bridge.studies.sweep.journal import Point
from controller.stability.amplitude.edges import swing
from controller.stability.amplitude.linear_law import relay_law
from controller.stability.amplitude.run import Course
from controller.stability.amplitude.swing import Swing, last_third

SIZE = 2e-3  # [m], of the step
SECONDS, PERIODS, DELAYS = 6.0, 60, 10  # of a run, the longest of them
PATIENCE = 12.0  # sampling periods of silence that a trial tolerates


class Place(NamedTuple):
    """Where a relay's loop is asked; seconds."""

    period: float
    delay: float
    derivative: float  # T_d


def own_place(scenario: Scenario) -> Place:
    """The scenario's own."""
    return Place(scenario.loop.sample_period, scenario.loop.delay, relay_of(scenario).derivative_time)


def length(place: Place) -> float:
    """Duration [s] of a run that can be judged, after its step."""
    return max(SECONDS, PERIODS * place.period, DELAYS * place.delay)


def _begin(place: Place) -> float:
    """When the reference steps [s]: the first sample from AT on."""
    return place.period * math.ceil(round(AT / place.period, 9))


def predicted(scenario: Scenario, places: Sequence[Place]) -> list[Swing]:
    """The swing of the reduced drive at each place."""
    loop, own = loop_of(scenario), relay_of(scenario)
    found = []
    for place in places:
        at = _begin(place)
        law = relay_law(place.derivative, own.source, own.filter_time, place.period, own.limit)
        when = Course(place.period, place.delay, at, at + length(place))
        found.append(swing(loop._replace(law=lambda _, law=law: law, when=when), 1.0, SIZE))
    return found


def on_grid(scenario: Scenario, place: Place) -> Place:
    """The nearest place that the scenario's time grid has."""
    daq, step = scenario.loop.daq_period, scenario.loop.step
    period = round(max(1, round(place.period / daq)) * daq, 9)
    return Place(period, round(round(place.delay / step) * step, 9), place.derivative)


def found_on_twin(scenario: Scenario, places: Sequence[Place], part: Path | None, crew: Crew) -> list[Swing]:
    """The swing of the twin at each place, on the scenario's time grid."""
    base = scenario.model_dump(mode="json")
    points = [on_grid(scenario, place)._asdict() for place in places]
    each = list({str(point): point for point in points}.values())
    results = sweep(partial(swing_of, base=base), each, {"title": "relay on the twin", "scenario": base}, part, crew)
    by_point = {str(point): Swing(**result) for point, result in zip(each, results, strict=True)}
    return [by_point[str(point)] for point in points]


def swing_of(point: Point, base: Mapping[str, Any]) -> dict[str, Any]:
    """Peak to peak [m] and frequency [Hz] of the twin at one place."""
    place = Place(**point)
    times = {"sample_period": place.period, "delay": place.delay, "command_timeout": PATIENCE * place.period}
    changes = [f"loop.{name}={value!r}" for name, value in times.items()]
    scenario = changed(dict(base), [*changes, f"controller.derivative_time={place.derivative!r}"], "sweep")
    asked, tick = stepped(scenario, SIZE), scenario.loop.daq_period
    lasts = tick * math.ceil(round((_begin(place) + length(place)) / tick, 6))
    trace = trial(asked.model_copy(update={"duration": lasts}), stand_of(scenario))
    return last_third(trace.time, trace.position)._asdict()
