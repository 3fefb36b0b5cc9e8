"""Runs laid over a chart of stability: the full twin at chosen places, through the same sampled controller."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from bridge.errors import UsageError
from bridge.studies.stability.chart import OfRig
from bridge.studies.stability.chart_drawing import ChartRun, Overlay
from bridge.studies.stability.edges import placed
from bridge.studies.stability.probe import STEP, stand_of, swing_at
from bridge.studies.sweep.engine import Crew, sweep
from bridge.studies.sweep.journal import Point


def twin_runs(
    family: OfRig, across: str, up: str, places: Sequence[tuple[float, float]], part: Path, crew: Crew
) -> Overlay:
    """Run the twin at each place (x, y) of a chart in rig units. Raises UsageError for an axis it does not have."""
    if "damping" in (across, up):
        raise UsageError("the twin has friction, but no damping to set; take gain, derivative, period or delay")
    base = family.asked.model_dump(mode="json")
    asked = {(x, y): _point({**family.numbers, across: x, up: y}, family) for x, y in places}
    points = list({str(point): point for point in asked.values()}.values())
    about = {"title": "runs of the twin", "scenario": base}
    found = sweep(partial(swing_of, base=base), points, about, part, crew)
    by_point = {str(point): result for point, result in zip(points, found, strict=True)}
    results = [(place, by_point[str(point)]) for place, point in asked.items()]
    runs = [
        ChartRun(x, y, bool(swing["oscillates"]), swing["frequency"], swing["amplitude"], None, None)
        for (x, y), swing in results
    ]
    return Overlay(runs, "runs of the full twin", ("Hz", "m"))


def _point(numbers: Mapping[str, float], family: OfRig) -> dict[str, float]:
    """The place in SI, on the scenario's time grid."""
    daq, step = family.asked.loop.daq_period, family.asked.loop.step
    return {
        **{name: float(family.si(name, np.asarray(numbers[name]))) for name in ("gain", "derivative")},
        "sample_period": round(max(1, round(numbers["period"] * 1e-3 / daq)) * daq, 9),
        "delay": round(round(numbers["delay"] * 1e-3 / step) * step, 9),
    }


def swing_of(point: Point, base: Mapping[str, Any]) -> dict[str, Any]:
    """What the twin does at one place."""
    derivative = {"derivative": f"{point['derivative']!r} s/m"} if "derivative" in base["controller"] else {}
    scenario = placed(point, {**base, "controller": base["controller"] | derivative})
    return swing_at(scenario, point["gain"], point.get("size", STEP), stand_of(scenario))._asdict()
