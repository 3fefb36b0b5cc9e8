"""The charts of a report: one run with all its signals, or several laid over one another."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from bridge.report.subject import Run
from bridge.report.thin import thinned

BAR, MM, L_MIN, UM, CM3 = 1e-5, 1e3, 6e4, 1e6, 1e6
BLUE, ORANGE, RED, GREEN, GREY, VIOLET = "#2a6fbb", "#e08a1e", "#c8413b", "#3a9150", "#8a8f98", "#8a5cc2"
RUNS = (BLUE, ORANGE, GREEN, VIOLET, RED, GREY)  # one run a colour, in an overlay


class Line(NamedTuple):
    """One signal of the true state."""

    field: str
    label: str
    colour: str
    held: bool = False


class Chart(NamedTuple):
    """One picture over time."""

    name: str
    title: str
    axis: str  # with its unit
    scale: float
    lines: tuple[Line, ...]
    reads: str  # what to see in it
    shown: Callable[[Run], bool] = lambda run: True


def _cavities(run: Run) -> bool:
    return any(np.max(run.state[name]) > 1e-9 for name in run.state if name.startswith("cavity_"))


CHARTS = (
    Chart(
        "position", "Position", "position [mm]", MM, (Line("position", "piston", BLUE),), "Piston and its reference."
    ),
    Chart(
        "pressure",
        "Pressures",
        "pressure [bar]",
        BAR,
        (
            Line("p1", "p1 at the relief valve", RED),
            Line("p_lower", "p2 lower chamber", BLUE),
            Line("p_upper", "p3 upper chamber", ORANGE),
        ),
        "True gauge pressures at the taps: the mean, and pale how far they went; -1 bar is the vapour pressure.",
    ),
    Chart(
        "valve",
        "Valve",
        "valve [of travel]",
        1.0,
        (Line("reference", "command", GREY, held=True), Line("spool", "spool", RED)),
        "Command in force and where the spool is; positive lifts.",
    ),
    Chart(
        "flow",
        "Flows",
        "flow [l/min]",
        L_MIN,
        (
            Line("flow_pump", "pump", GREY),
            Line("flow_relief", "relief valve", RED),
            Line("flow_3", "to the lower chamber", BLUE),
            Line("flow_4", "to the upper chamber", ORANGE),
        ),
        "What the pump delivers, what the relief valve takes, what reaches the cylinder.",
    ),
    Chart(
        "relief",
        "Relief valve",
        "lift [um]",
        UM,
        (Line("relief_spool", "main spool", BLUE), Line("relief_pilot", "pilot poppet", RED)),
        "Lifts from their seats.",
    ),
    Chart(
        "cavities",
        "Cavities",
        "vapour [cm³]",
        CM3,
        (
            Line("cavity_lower", "lower chamber", BLUE),
            Line("cavity_upper", "upper chamber", ORANGE),
            Line("cavity_a", "port A", VIOLET),
            Line("cavity_b", "port B", GREEN),
            Line("cavity_t", "port T", RED),
            Line("cavity_return", "return tee", GREY),
        ),
        "Where the oil cannot follow, it leaves vapour.",
        _cavities,
    ),
)


def draw_chart(chart: Chart, runs: Sequence[Run], names: Sequence[str]) -> Any:
    """A matplotlib figure: of one run all lines in one picture; of several a picture a line, the runs in it."""
    moved = tuple(line for line in chart.lines if any(np.any(run.state[line.field]) for run in runs))
    chart = chart._replace(lines=moved or chart.lines[:1])
    if len(runs) == 1:
        return _single(chart, runs[0])
    return _overlay(chart, runs, names)


def _single(chart: Chart, run: Run) -> Any:
    figure, (axis,) = canvas(1, 2.5)
    if chart.name == "position" and np.isfinite(run.reference).any():
        axis.plot(run.time, run.reference * MM, color=GREY, linestyle="--", linewidth=1.2, label="reference")
    for line in chart.lines:
        _plot(axis, run, line, chart, line.label, line.colour)
    _finish(axis, chart.axis, run.time[-1])
    return figure


def _overlay(chart: Chart, runs: Sequence[Run], names: Sequence[str]) -> Any:
    figure, axes = canvas(len(chart.lines), 1.75)
    for axis, line in zip(axes, chart.lines, strict=True):
        for run, name, colour in zip(runs, names, RUNS, strict=False):
            _plot(axis, run, line, chart, name, colour)
        axis.set_title(line.label, fontsize=9, loc="left")
        _finish(axis, chart.axis, max(run.time[-1] for run in runs), last=axis is axes[-1])
    return figure


def _plot(axis: Any, run: Run, line: Line, chart: Chart, label: str, colour: str) -> None:
    """A line; where it is faster than the page can show, its mean in a band as wide as it goes."""
    values = run.state[line.field] * chart.scale
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


def _finish(axis: Any, label: str, end: float, last: bool = True) -> None:
    axis.set_xlim(0.0, end)
    axis.set_ylabel(label, fontsize=9)
    if last:
        axis.set_xlabel("time [s]", fontsize=9)
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, frameon=False, ncols=6, borderpad=0.1)
