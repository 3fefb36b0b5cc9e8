"""A chart of a relay's loop on a rig: how far it swings over two of its times, with runs of the twin laid over."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError
from bridge.scenario import Scenario
from bridge.studies.stability.amplitude import threaded
from bridge.studies.stability.chart_drawing import ChartRun, Overlay
from bridge.studies.stability.relay_lead import needed_lead
from bridge.studies.stability.relay_swing import (
    Place,
    found_on_twin,
    on_grid,
    own_place,
    predicted,
)
from bridge.studies.sweep.engine import Crew

AXES = ("period", "delay", "derivative")
MOST_CELLS = 60  # per side: each is a run of the reduced drive
CLASSES = (0.3, 2.0, 5.0, 15.0)  # [mm], peak to peak, between the colours
LEAST = 1.0  # [ms], the shortest period that is asked for
WIDEST = {"period": 20.0, "delay": 20.0, "derivative": 50.0}  # [ms], of an axis nobody asked a range for

Array = NDArray[np.float64]


class RelayChart(NamedTuple):
    """Predicted swings on a grid; arrays are (up, across), times in ms."""

    across: str
    up: str
    x: Array
    y: Array
    peak: Array  # peak to peak [mm]
    frequency: Array  # [Hz]; 0.0: irregular
    lead: Array  # T_d that (5.22) asks for [ms]
    labels: tuple[str, str]
    about: str
    fixed: dict[str, float]


def relay_chart(scenario: Scenario, across: str, up: str, x: Array, y: Array, own: Mapping[str, float]) -> RelayChart:
    """The reduced drive over two of AXES; own: the numbers of AXES in ms that are not on one."""
    shape = len(y), len(x)
    places = [_place({**own, across: a, up: b}) for b in y.tolist() for a in x.tolist()]
    rows = [places[k : k + len(x)] for k in range(0, len(places), len(x))]
    swings = [one for row in threaded(lambda row: predicted(scenario, row), rows) for one in row]
    lead = [1e3 * needed_lead(scenario, place.period, place.delay) for place in places]
    rest = {"mass [kg]": scenario.rig.load.mass, "position [mm]": 1e3 * scenario.start.position}
    return RelayChart(
        across,
        up,
        x,
        y,
        np.array([1e3 * one.peak_to_peak for one in swings]).reshape(shape),
        np.array([one.frequency for one in swings]).reshape(shape),
        np.array(lead).reshape(shape),
        (f"{across} [ms]", f"{up} [ms]"),
        f"{scenario.name}, {scenario.rig.valve.kind} valve",
        {f"{name} [ms]": own[name] for name in AXES if name not in (across, up)} | rest,
    )


def own_numbers(scenario: Scenario) -> dict[str, float]:
    """The scenario's times in ms."""
    return {name: 1e3 * value for name, value in own_place(scenario)._asdict().items()}


def relay_runs(
    scenario: Scenario,
    across: str,
    up: str,
    places: Sequence[tuple[float, float]],
    own: Mapping[str, float],
    part: Path,
    crew: Crew,
) -> Overlay:
    """The twin at each place (x, y) of the chart, on the scenario's time grid."""
    asked = [on_grid(scenario, _place({**own, across: x, up: y})) for x, y in places]
    swings = found_on_twin(scenario, asked, part, crew)
    runs = [
        ChartRun(x, y, swing.counts, swing.frequency, 0.5 * swing.peak_to_peak, None, None)
        for (x, y), swing in zip(places, swings, strict=True)
    ]
    return Overlay(runs, "runs of the full twin, coloured by their own peak to peak", ("Hz", "m"))


def refuse_axes(across: str, up: str) -> None:
    """Raises UsageError for an axis that a relay's loop does not have."""
    for axis in (across, up):
        if axis not in AXES:
            raise UsageError(f"a relay has no {axis!r} to vary; take two of {', '.join(AXES)}")
    if across == up:
        raise UsageError(f"both axes are {across!r}; take two of {', '.join(AXES)}")


def _place(numbers: Mapping[str, float]) -> Place:
    return Place(*(1e-3 * max(numbers[name], LEAST if name == "period" else 0.0) for name in AXES))


def classes(peak: Array) -> NDArray[np.int64]:
    """Which colour a swing [mm] has."""
    return np.digitize(peak, CLASSES)


def class_words(number: int) -> str:
    """What a colour stands for."""
    if number == 0:
        return f"settles: below {CLASSES[0]:g} mm"
    if number == len(CLASSES):
        return f"swings by more than {CLASSES[-1]:g} mm, peak to peak"
    return f"swings by {CLASSES[number - 1]:g} to {CLASSES[number]:g} mm"


def plain(chart: RelayChart) -> dict[str, Any]:
    """What the page shows."""
    return {
        "x": chart.x.tolist(),
        "y": chart.y.tolist(),
        "labels": chart.labels,
        "outside": classes(chart.peak).tolist(),
        "peak": np.round(chart.peak, 4).tolist(),
        "often": np.round(chart.frequency, 4).tolist(),
        "words": [class_words(n) for n in range(len(CLASSES) + 1)],
    }
