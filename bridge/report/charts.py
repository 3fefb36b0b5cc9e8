"""The charts of a report: one run with all its signals, or several laid over one another."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from bridge.drawing.colours import LIGHT
from bridge.drawing.thin import thinned
from bridge.recording.changes import changes, mark, shade, spans
from bridge.recording.shown import GROUPS, MEASURED, Curve, Group
from bridge.report.subject import Run
from bridge.scenario.fitted import kind_of, of_drive, positive_words
from twin.topology import CAVITIES

RUNS = tuple(LIGHT[name] for name in ("blue", "orange", "green", "violet", "red", "grey"))  # one per run, in an overlay
MEASURED_WORDS = "Of what was measured on a rig: what its sensors read, and the command that was sent."
LEAST_CAVITY = 1e-9  # [m^3]


class Chart(NamedTuple):
    """One picture over time."""

    name: str  # of its group
    reads: str  # what to see in it
    shown: Callable[[Run], bool] = lambda run: True

    @property
    def group(self) -> Group:
        """What is drawn in it."""
        return GROUPS[self.name]

    def caption(self, runs: Sequence[Run]) -> str:
        """What to see in it, in the words of the first run's drive."""
        values = runs[0].scenario.rig_values()
        words = of_drive(self.reads, values).replace("positive lifts", f"positive {positive_words(values)}")
        measured = [run.measured for run in runs]
        return " ".join(([] if all(measured) else [words]) + [MEASURED_WORDS] * any(measured))

    def filled(self, runs: Sequence[Run]) -> bool:
        """Does any run know anything of it?"""
        return any(run.knows(curve.field) for run in runs for curve in self.group.curves)

    @property
    def title(self) -> str:
        """Its heading."""
        return self.group.title


def _cavities(run: Run) -> bool:
    return any(np.max(run.state[name]) > LEAST_CAVITY for name in CAVITIES if name in run.state)


def _two_stages(run: Run) -> bool:
    return kind_of(run.scenario.rig_values(), "relief valve") == "two-stage"


CHARTS = (
    Chart("position", "Piston and its reference."),
    Chart(
        "pressure",
        "True gauge pressures at the taps: the mean, and pale how far they went; -1 bar is the vapour pressure.",
    ),
    *(Chart(name, "True values of what the card measures.") for name in MEASURED),
    Chart("valve", "Command in force and where the spool is; positive lifts."),
    Chart("flow", "What the pump delivers, what the relief valve takes, what reaches the cylinder."),
    Chart("relief", "Lifts from their seats.", _two_stages),
    Chart("cavities", "Where the oil cannot follow, it leaves vapour.", _cavities),
)


def draw_chart(chart: Chart, runs: Sequence[Run], names: Sequence[str]) -> Any:
    """A matplotlib figure: of one run all lines in one picture; of several one picture per line, the runs in it."""
    curves = chart.group.curves
    known = [curve for curve in curves if any(run.knows(curve.field) for run in runs)]
    moved = tuple(curve for curve in known if any(np.any(run.state.get(curve.field, 0.0)) for run in runs))
    group = chart.group._replace(curves=moved or tuple(known[:1]))
    return _single(group, runs[0]) if len(runs) == 1 else _overlay(group, runs, names)


def _single(group: Group, run: Run) -> Any:
    figure, (axis,) = canvas(1, 2.5)
    if group.curves[0].field == "position" and np.isfinite(run.reference).any():
        axis.plot(
            run.time, run.reference * group.scale, color=LIGHT["grey"], linestyle="--", linewidth=1.2, label="reference"
        )
    for line in group.curves:
        _plot(axis, run, line, group.scale, _words(line, run), LIGHT[line.colour])
    mark(axis, changes(run.recording))
    shade(axis, spans(run.recording), run.time[-1])
    finish(axis, group.axis, run.time[-1])
    return figure


def _overlay(group: Group, runs: Sequence[Run], names: Sequence[str]) -> Any:
    figure, axes = canvas(len(group.curves), 1.75)
    for axis, line in zip(axes, group.curves, strict=True):
        for run, name, colour in zip(runs, names, RUNS, strict=False):
            if run.knows(line.field):
                _plot(axis, run, line, group.scale, name, colour)
        axis.set_title(_words(line, runs[0]), fontsize=9, loc="left")
        finish(axis, group.axis, max(run.time[-1] for run in runs), last=axis is axes[-1])
    return figure


def _words(line: Curve, run: Run) -> str:
    """Its label, in the words of the run's drive."""
    return of_drive(line.label, run.scenario.rig_values())


def _plot(axis: Any, run: Run, line: Curve, scale: float, label: str, colour: str) -> None:
    """A line; where it is faster than the page can show, its mean in a band as wide as it goes."""
    values = run.state[line.field] * scale
    if line.held:
        rows = np.flatnonzero(np.diff(values, prepend=np.nan, append=np.nan))[:-1]
        rows = np.append(rows, len(values) - 1)
        axis.plot(run.time[rows], values[rows], color=colour, linewidth=1.0, label=label, drawstyle="steps-post")
        return
    course = thinned(run.time, values)
    axis.fill_between(course.time, course.least, course.greatest, color=colour, alpha=0.22, linewidth=0.3)
    axis.plot(course.time, course.mean, color=colour, linewidth=1.1, label=label)


def canvas(rows: int, height: float) -> tuple[Any, list[Any]]:
    """A figure as wide as the page, and its axes one above the other."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 0.4 + height * rows), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, 1, squeeze=False)[:, 0]
    for axis in axes:
        axis.grid(color="#d9dde3", linewidth=0.6)
        axis.spines[["top", "right"]].set_visible(False)
        axis.tick_params(labelsize=8, colors="#444")
    return figure, list(axes)


def finish(axis: Any, label: str, end: float, last: bool = True) -> None:
    """Name the axes of a picture over time, and its curves."""
    axis.set_xlim(0.0, end)
    axis.set_ylabel(label, fontsize=9)
    if last:
        axis.set_xlabel("time [s]", fontsize=9)
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, frameon=False, ncols=6, borderpad=0.1)
