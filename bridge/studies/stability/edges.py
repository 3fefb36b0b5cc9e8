"""Edges of stability of a scenario's rig over its sampling interval and delay: by theory, and found on the twin."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from bridge.scenario import Scenario, changed
from bridge.scenario.gains import gains
from bridge.studies.stability.causes import CAUSES, DEAD_BAND, with_causes
from bridge.studies.stability.probe import STEP, TOLERANCE, critical_gain
from bridge.studies.stability.rig_loop import RigTiming, timing_of
from bridge.studies.stability.rig_loop import edge_of as theory_edge
from bridge.studies.stability.rig_plant import RigPlant, at_rest, plants
from bridge.studies.sweep.engine import ALL_CORES, Crew, sweep
from bridge.studies.sweep.journal import Point

PATIENCE = 12.0  # sampling intervals of silence that a trial tolerates


def theory_edges(found: Mapping[str, RigPlant], timing: RigTiming, derivative: float) -> dict[str, list[Any]]:
    """For each point of the rig its critical gain [1/m], its kind and frequency [Hz]."""
    return {name: [*theory_edge(point.plant(), timing, derivative)] for name, point in found.items()}


def edge_of(point: Point, base: Mapping[str, Any]) -> dict[str, Any]:
    """The edge at one point of a sweep: the theory's, and the twin's.

    point: sample_period, delay, size of the step; causes, where only these are to act. base: the scenario's plain data.
    """
    scenario = placed(point, base)
    theory = _theory(scenario)
    least = min(gain for gain, _, _ in theory.values())
    first = theory.get("rest", [least])[0]
    try:
        found = critical_gain(scenario, first, point["size"], point.get("tolerance", TOLERANCE))._asdict()
    except ValueError as error:
        found = {"stable": None, "unstable": None, "frequency": None, "amplitude": None, "why": str(error)}
    return {"theory": theory, **found}


def _theory(scenario: Scenario) -> dict[str, list[Any]]:
    """The theory's edges, kept since the steps at one interval have the same."""
    key = f"{scenario.rig!r} {scenario.start!r} {scenario.loop!r} {scenario.controller!r}"
    if key not in _KEPT:
        _KEPT.clear()
        _KEPT[key] = theory_edges(plants(scenario), timing_of(scenario), gains(scenario).derivative)
    return _KEPT[key]


_KEPT: dict[str, dict[str, list[Any]]] = {}


def placed(point: Point, base: Mapping[str, Any]) -> Scenario:
    """The scenario of one point of a sweep."""
    interval = point["sample_period"]
    times = {"sample_period": interval, "delay": point["delay"], "command_timeout": PATIENCE * interval}
    scenario = changed(dict(base), [f"loop.{name}={value!r}" for name, value in times.items()], "sweep")
    return with_causes(scenario, point["causes"]) if "causes" in point else at_rest(scenario)


def edge_points(
    intervals: Sequence[float],
    delays: Sequence[float] = (0.0,),
    sizes: Sequence[float] = (STEP,),
    causes: Sequence[Sequence[str]] | None = None,
    tolerance: float = TOLERANCE,
) -> list[dict[str, Any]]:
    """Points of a sweep over all combinations."""
    cases: list[dict[str, Any]] = [{}] if causes is None else [{"causes": list(case)} for case in causes]
    return [
        {"sample_period": interval, "delay": delay, "size": size, "tolerance": tolerance, **case}
        for case in cases
        for interval in intervals
        for delay in delays
        for size in sizes
    ]


def measured_edges(
    scenario: Scenario, points: Sequence[Point], title: str, part: Path | None = None, crew: Crew = ALL_CORES
) -> list[Any]:
    """The edges at all points."""
    base = scenario.model_dump(mode="json")
    return sweep(partial(edge_of, base=base), points, {"title": title, "scenario": base}, part, crew)


def cases_of_causes() -> dict[str, list[str]]:
    """None of them, each alone, all."""
    return {"none": [], **{cause: [cause] for cause in CAUSES}, DEAD_BAND: ["overlap", DEAD_BAND], "all": list(CAUSES)}
