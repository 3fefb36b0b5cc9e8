"""The signals that laws have logged: a chart for each unit."""

from collections.abc import Sequence
from itertools import cycle
from typing import Any, NamedTuple

import numpy as np

from bridge.drawing.colours import LIGHT
from bridge.recording.shown import ORDER
from bridge.recording.signals import Signal, signals_of
from bridge.report.charts import RUNS, canvas, finish
from bridge.report.subject import Run
from bridge.report.thin import STRETCHES, thinned
from bridge.scenario.units import shown
from controller.grid import NS

CAPTION = "What the law has logged at its samples, each value held until the next one."


class OwnChart(NamedTuple):
    """The signals of one unit."""

    unit: str  # SI
    names: tuple[str, ...]

    @property
    def axis(self) -> str:
        """What the axis says."""
        unit = shown(self.unit)[1]
        return f"logged [{unit}]" if unit else "logged"

    @property
    def title(self) -> str:
        """Its heading."""
        unit = shown(self.unit)[1]
        return f"Signals of the law{f' [{unit}]' if unit else ''}"


def own_signals(run: Run) -> dict[str, Signal]:
    """What the law of a run has logged, by the names it gave."""
    return {name.partition(".")[2]: signal for name, signal in signals_of(run.recording, ("signals",)).items()}


def own_charts(runs: Sequence[Run]) -> list[OwnChart]:
    """The charts that there is something for."""
    found: dict[str, dict[str, None]] = {}
    for run in runs:
        for name, signal in own_signals(run).items():
            found.setdefault(signal.unit, {})[name] = None
    return [OwnChart(unit, tuple(names)) for unit, names in found.items()]


def draw_own(chart: OwnChart, runs: Sequence[Run], names: Sequence[str]) -> Any:
    """A matplotlib figure: of one run all signals in one picture; of several one picture per signal."""
    end = max(run.time[-1] for run in runs)
    if len(runs) == 1:
        figure, (axis,) = canvas(1, 2.5)
        signals = own_signals(runs[0])
        for name, colour in zip(chart.names, cycle(ORDER), strict=False):
            _plot(axis, signals[name], name, LIGHT[colour])
        finish(axis, chart.axis, end)
        return figure
    figure, axes = canvas(len(chart.names), 1.75)
    for axis, signal in zip(axes, chart.names, strict=True):
        for run, name, colour in zip(runs, names, RUNS, strict=False):
            if (found := own_signals(run).get(signal)) is not None and found.unit == chart.unit:
                _plot(axis, found, name, colour)
        axis.set_title(signal, fontsize=9, loc="left")
        finish(axis, chart.axis, end, last=axis is axes[-1])
    return figure


def _plot(axis: Any, signal: Signal, label: str, colour: str) -> None:
    time, values = signal.stamp / NS, signal.value * shown(signal.unit)[0]
    with np.errstate(invalid="ignore"):
        course = thinned(time, values)
    if len(time) > STRETCHES:
        axis.fill_between(course.time, course.least, course.greatest, color=colour, alpha=0.22, linewidth=0.3)
    held = "default" if len(time) > STRETCHES else "steps-post"
    axis.plot(course.time, course.mean, color=colour, linewidth=1.1, label=label, drawstyle=held)
