"""One picture of a run: position and reference, pressures, valve; relief valve and vapour where they moved; in real
time also how late the ticks were.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from bridge.drawing.colours import LIGHT
from bridge.recording.changes import caption, changes, mark, number, shade, spans
from bridge.recording.columns import followed, relief_moved, vapour
from bridge.recording.reader import Recording
from bridge.recording.seen import seen
from bridge.recording.shown import GROUPS, MEASURED
from bridge.scenario import Scenario
from bridge.scenario.fitted import kind_of, of_drive
from controller.grid import NS

Row = Callable[[Any, Any, Any, Scenario], None]  # axis, time, state, scenario
MOST_POINTS = 20_000
LEAST_VAPOUR = 1e-8  # [m^3], less is not worth a row


def draw(recording: Recording, scenario: Scenario, path: Path) -> Path:
    """Draw a recording to a PNG and return its path."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    state = seen(recording)
    thin = slice(None, None, max(1, len(state["stamp"]) // MOST_POINTS))
    timing = recording.columns("timing")
    happened = ((_relief, relief_moved(state)), (_vapour, vapour(state).max() > LEAST_VAPOUR))
    rows = [_position, _pressures, *map(_measured, MEASURED), _valve, *(row for row, shown in happened if shown)]
    state = {name: values[thin] for name, values in state.items()}
    heights = [HEIGHTS.get(row, 2.4) for row in rows] + [2.4] * bool(len(timing["tick"]))
    figure = Figure(figsize=(10, sum(heights)), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(len(heights), 1, height_ratios=heights)
    time = state["stamp"] / NS
    state["followed"] = followed(recording, scenario, time)
    changed, safety = changes(recording), spans(recording)
    for axis, row in zip(axes, rows, strict=False):
        row(axis, time, state, scenario)
        mark(axis, changed)
        shade(axis, safety, time[-1])
        axis.set_xlim(0.0, time[-1])
        axis.grid(alpha=0.3)
        axis.tick_params(labelbottom=row is rows[-1])
    axes[len(rows) - 1].set_xlabel("time [s]")
    number(axes[0], changed)
    if changed:
        figure.supxlabel(caption(changed), x=0.01, ha="left", fontsize="small", parse_math=False)
    figure.align_ylabels(axes)
    if len(timing["tick"]):
        _lateness(axes[-1], timing)
    figure.suptitle(scenario.title or scenario.name, parse_math=False)
    figure.savefig(path)
    return path


def _position(axis: Any, time: Any, state: Any, scenario: Scenario) -> None:
    if np.isfinite(state["followed"]).any():
        scale = GROUPS["position"].scale
        axis.plot(time, state["followed"] * scale, color="0.4", linestyle="--", linewidth=1.2, label="reference")
    _curves(axis, time, state, "position", scenario)


def _pressures(axis: Any, time: Any, state: Any, scenario: Scenario) -> None:
    _curves(axis, time, state, "pressure", scenario)


def _measured(name: str) -> Row:
    return lambda axis, time, state, scenario: _curves(axis, time, state, name, scenario)


def _curves(axis: Any, time: Any, state: Any, name: str, scenario: Scenario) -> None:
    """The signals of a group."""
    group, rig = GROUPS[name], scenario.rig_values()
    for curve in group.curves:
        style = "steps-post" if curve.held else "default"
        values = state[curve.field] * group.scale
        axis.plot(
            time, values, color=LIGHT[curve.colour], linewidth=1.0, label=of_drive(curve.label, rig), drawstyle=style
        )
    axis.set_ylabel(group.axis)
    axis.legend(loc="best", fontsize="small", ncols=3)


def _valve(axis: Any, time: Any, state: Any, scenario: Scenario) -> None:
    _curves(axis, time, state, "valve", scenario)
    axis.set_ylim(-1.05, 1.05)


def _relief(axis: Any, time: Any, state: Any, scenario: Scenario) -> None:
    """Flow, and of a two-stage valve on an axis of their own the lifts of both stages."""
    flow, lift = GROUPS["flow"], GROUPS["relief"]
    axis.fill_between(time, state["flow_relief"] * flow.scale, color="C0", alpha=0.35, linewidth=0.0, label="flow")
    axis.set_ylabel(f"relief [{flow.unit}]")
    axis.set_ylim(bottom=0.0)
    if kind_of(scenario.rig_values(), "relief valve") != "two-stage":
        return
    lifts = axis.twinx()
    for curve in lift.curves:
        colour = LIGHT[curve.colour]
        lifts.plot(time, state[curve.field] * lift.scale, color=colour, linewidth=0.8, alpha=0.8, label=curve.label)
    lifts.set_ylabel(lift.axis)
    lifts.set_ylim(bottom=0.0)
    lifts.legend(
        *map(list.__add__, axis.get_legend_handles_labels(), lifts.get_legend_handles_labels()),
        loc="best",
        fontsize="small",
        ncols=3,
    )


def _vapour(axis: Any, time: Any, state: Any, _: Scenario) -> None:
    axis.fill_between(time, vapour(state) * GROUPS["cavities"].scale, color="C4", alpha=0.5, linewidth=0.0)
    axis.set_ylabel(GROUPS["cavities"].axis)
    axis.set_ylim(bottom=0.0)


HEIGHTS = {_relief: 1.5, _vapour: 1.2}  # [inch], of rows that are not of the common height


def _lateness(axis: Any, timing: Any) -> None:
    late = np.maximum(timing["lateness"], 1) / 1e3
    trips = timing["round_trip"][timing["round_trip"] > 0] / 1e3
    edges = np.logspace(-2, 5, 85)
    axis.hist(late, edges, histtype="step", color="C0", label="lateness of the ticks")
    if len(trips):
        axis.hist(trips, edges, histtype="step", color="C1", label="measurement to command")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("wall time [us]")
    axis.set_ylabel("ticks")
    axis.grid(alpha=0.3)
    axis.legend(loc="best", fontsize="small")
