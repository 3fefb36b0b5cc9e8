"""Runs laid over a dimensionless chart of stability: the whole nonlinear actuator under the same sampled controller."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bridge.studies.stability.chart import Plainly
from bridge.studies.stability.chart_drawing import ChartRun, Overlay
from bridge.studies.sweep.engine import Crew, sweep
from bridge.studies.sweep.journal import Point
from controller.stability.actuator.disagreement import causes
from controller.stability.actuator.oscillation import (
    KEPT,
    PLAIN,
    Loops,
    checked,
    oscillations,
)

OWN = {"alpha": PLAIN.alpha, "limit": PLAIN.limit, "start": PLAIN.start}  # what linear theory does not ask for
NAMES = {"gain": "s", "derivative": "d", "period": "tau", "delay": "delay", "damping": "k"}  # of the chart's numbers


def actuator_runs(
    family: Plainly, across: str, up: str, places: Sequence[tuple[float, float]], part: Path, crew: Crew
) -> Overlay:
    """Run the actuator at each place (x, y) of a chart, with the family's numbers and those of OWN.

    Raises ValueError where one of them cannot be.
    """
    points = [point_of(family, {**OWN, **family.numbers, across: x, up: y}) for x, y in places]
    for point in points:
        checked(Loops(**point))
    found = sweep(run_of, points, {"title": "runs of the actuator"}, part, crew)
    runs = [ChartRun(x, y, **result) for (x, y), result in zip(places, found, strict=True)]
    start = {**OWN, **family.numbers}["start"]
    words = f"runs of the nonlinear actuator, let go {start:g} alpha from its target"
    criterion = f"A run oscillates if its last third swings by {100.0 * KEPT:.0f} % of its middle third or more"
    return Overlay(runs, f"{words}. {criterion}", ("omega", "L"))


def point_of(family: Plainly, numbers: Mapping[str, Any]) -> Point:
    """A loop as plain data."""
    named = {NAMES.get(name, name): float(value) for name, value in numbers.items()}
    lag = family.filter_time if family.derivative == "filtered" else None
    return {**named, "derivative": family.derivative, "filter_time": lag}


def run_of(point: Point) -> dict[str, Any]:
    """What the actuator does at one place, and why it and theory disagree if they do."""
    loop = Loops(**point)
    found = oscillations(loop)
    return {
        "oscillates": bool(found.oscillates),
        "frequency": float(found.frequency) if found.oscillates else 0.0,
        "amplitude": float(found.amplitude),
        "saturated": float(found.saturated),
        "cause": str(causes(loop, found)),
    }
