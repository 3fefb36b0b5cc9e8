"""What only some runs have: signals that laws have logged, and further channels of the card; a chart for each unit."""

from collections.abc import Sequence
from itertools import cycle
from typing import Any, NamedTuple

import numpy as np

from bridge.drawing.colours import LIGHT
from bridge.drawing.thin import STRETCHES, thinned
from bridge.recording.shown import ORDER
from bridge.recording.signals import Signal, signals_of
from bridge.report.charts import RUNS, canvas, finish
from bridge.report.subject import Run
from bridge.scenario.units import shown
from bridge.wire.messages import CHANNELS_TOPIC
from controller.grid import NS


class Kind(NamedTuple):
    """Where such signals come from."""

    topic: str
    heading: str
    what: str  # on the axis
    caption: str
    held: bool  # a value is in force until the next one


LOGGED = Kind(
    "signals",
    "Signals of the law",
    "logged",
    "What the law has logged at its samples, each value held until the next one.",
    True,
)
READ = Kind(
    CHANNELS_TOPIC,
    "Further channels",
    "measured",
    "What the card read, with its noise, its resolution and the ends of its ranges.",
    False,
)


class OwnChart(NamedTuple):
    """The signals of one unit."""

    unit: str  # SI
    names: tuple[str, ...]
    kind: Kind = LOGGED

    @property
    def axis(self) -> str:
        """What the axis says."""
        return self._with_unit(self.kind.what)

    @property
    def title(self) -> str:
        """Its heading."""
        return self._with_unit(self.kind.heading)

    def _with_unit(self, words: str) -> str:
        unit = shown(self.unit)[1]
        return f"{words} [{unit}]" if unit else words


def own_signals(run: Run, kind: Kind = LOGGED) -> dict[str, Signal]:
    """Those of a run, by their own names."""
    return {name.partition(".")[2]: signal for name, signal in signals_of(run.recording, (kind.topic,)).items()}


def own_charts(runs: Sequence[Run]) -> list[OwnChart]:
    """The charts that there is something for."""
    found: dict[tuple[Kind, str], dict[str, None]] = {}
    for kind in (READ, LOGGED):
        for run in runs:
            for name, signal in own_signals(run, kind).items():
                found.setdefault((kind, signal.unit), {})[name] = None
    return [OwnChart(unit, tuple(names), kind) for (kind, unit), names in found.items()]


def draw_own(chart: OwnChart, runs: Sequence[Run], names: Sequence[str]) -> Any:
    """A matplotlib figure: of one run all signals in one picture; of several one picture per signal."""
    end = max(run.time[-1] for run in runs)
    if len(runs) == 1:
        figure, (axis,) = canvas(1, 2.5)
        signals = own_signals(runs[0], chart.kind)
        for name, colour in zip(chart.names, cycle(ORDER), strict=False):
            _plot(axis, signals[name], name, LIGHT[colour], chart.kind.held)
        finish(axis, chart.axis, end)
        return figure
    figure, axes = canvas(len(chart.names), 1.75)
    for axis, signal in zip(axes, chart.names, strict=True):
        for run, name, colour in zip(runs, names, RUNS, strict=False):
            if (found := own_signals(run, chart.kind).get(signal)) is not None and found.unit == chart.unit:
                _plot(axis, found, name, colour, chart.kind.held)
        axis.set_title(signal, fontsize=9, loc="left")
        finish(axis, chart.axis, end, last=axis is axes[-1])
    return figure


def _plot(axis: Any, signal: Signal, label: str, colour: str, steps: bool) -> None:
    time, values = signal.stamp / NS, signal.value * shown(signal.unit)[0]
    with np.errstate(invalid="ignore"):
        course = thinned(time, values)
    if len(time) > STRETCHES:
        axis.fill_between(course.time, course.least, course.greatest, color=colour, alpha=0.22, linewidth=0.3)
    held = "steps-post" if steps and len(time) <= STRETCHES else "default"
    axis.plot(course.time, course.mean, color=colour, linewidth=1.1, label=label, drawstyle=held)
