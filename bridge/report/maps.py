"""Pressure over length and time, all six pipes one above the other, and the spread of wall times."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from bridge.drawing.colours import LIGHT, STOPS
from bridge.recording.shown import line_ends
from bridge.report.charts import RUNS, canvas
from bridge.report.subject import Run
from twin.topology import LINES, PIPES

MOST_COLUMNS = 1200
EDGES = np.logspace(-1, 5, 91)  # [us]


def draw_maps(run: Run) -> Any:
    """The maps of a run."""
    from matplotlib.cm import ScalarMappable

    time, pressure = run.along()
    figure, axes = canvas(LINES, 1.05)
    values, norm, colours = run.scenario.rig_values(), *_scale()
    ends = line_ends(values)
    for pipe, (name, axis) in enumerate(zip(PIPES, axes, strict=True)):
        length = values[name]["length"]
        step = max(1, -(-len(time) // MOST_COLUMNS))
        extent = (time[0], time[-1], 0.0, length)
        axis.imshow(
            pressure[::step, pipe].T * 1e-5, origin="lower", aspect="auto", extent=extent, norm=norm, cmap=colours
        )
        axis.grid(visible=False)
        axis.set_ylabel(f"pipe {pipe + 1} [m]", fontsize=8)
        axis.set_title(f"{ends[pipe][0]} (0 m) to {ends[pipe][1]} ({length:g} m)", fontsize=8, loc="left")
        if axis is not axes[-1]:
            axis.tick_params(labelbottom=False)
    axes[-1].set_xlabel("time [s]", fontsize=9)
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, fraction=0.025, pad=0.01)
    bar.set_label("pressure [bar]", fontsize=9)
    bar.ax.tick_params(labelsize=8)
    return figure


def _scale() -> tuple[Any, Any]:
    """The colours of the view as matplotlib has them."""
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    low, high = STOPS[0][0], STOPS[-1][0]
    stops = [((bar - low) / (high - low), (r / 255, g / 255, b / 255)) for bar, r, g, b in STOPS]
    return Normalize(low, high), LinearSegmentedColormap.from_list("pressure", stops, N=512)


def draw_timing(runs: Sequence[Run], names: Sequence[str]) -> Any:
    """Histograms of the lateness of the ticks and of the round trips; None when no run was in real time."""
    timings = [(run.recording.columns("timing"), name) for run, name in zip(runs, names, strict=True)]
    if not any(len(timing["tick"]) for timing, _ in timings):
        return None
    figure, (axis,) = canvas(1, 2.8)
    single = len(runs) == 1
    for (timing, name), colour in zip(timings, RUNS, strict=False):
        trips = timing["round_trip"][timing["round_trip"] > 0]
        lead = "" if single else f"{name}: "
        _histogram(axis, timing["lateness"], f"{lead}lateness of the ticks", LIGHT["blue"] if single else colour, "-")
        _histogram(
            axis, trips, f"{lead}measurement to command", LIGHT["orange"] if single else colour, "-" if single else "--"
        )
    axis.set(xscale="log", yscale="log")
    axis.set_xlabel("wall time [us]", fontsize=9)
    axis.set_ylabel("ticks", fontsize=9)
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, frameon=False, ncols=2)
    return figure


def _histogram(axis: Any, values: Any, label: str, colour: str, line: str) -> None:
    if len(values):
        shown = np.clip(values / 1e3, EDGES[0], EDGES[-1])
        axis.hist(shown, EDGES, histtype="step", color=colour, linestyle=line, label=label)
