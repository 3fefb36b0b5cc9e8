"""The picture of one run for the page of a campaign: position, pressures, valve, as an inline drawing."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from bridge.drawing.colours import LIGHT
from bridge.drawing.html import svg
from bridge.drawing.thin import thinned
from bridge.errors import RunError, UsageError
from bridge.recording.changes import changes, mark, shade, spans
from bridge.recording.columns import followed
from bridge.recording.reader import Recording
from bridge.recording.shown import GROUPS
from bridge.runs.campaign.made import Plain, scenario_of
from bridge.runs.sweep.point import run_alone
from bridge.scenario import Scenario
from bridge.scenario.fitted import of_drive
from bridge.studies.sweep.journal import Point, Result
from controller.grid import NS

ROWS = ("position", "pressure", "valve")
STRETCHES = 240  # of a curve
WIDTH, HEIGHT = 9.6, 1.25  # [inch], of a row


def pictured(point: Point, bases: Mapping[str, Plain], pieces: Mapping[str, Plain]) -> Result:
    """The run of a point again, drawn: `svg`, and why there is no picture (`reason`)."""
    try:
        scenario = scenario_of(point, bases, pieces)
        found, _ = run_alone(scenario)
    except (UsageError, RunError) as error:
        return {"svg": "", "reason": "; ".join(str(error).splitlines())}
    return {"svg": svg(draw(found, scenario), point["picture"], f"run of {scenario.name}"), "reason": ""}


def draw(found: Recording, scenario: Scenario) -> Any:
    """A matplotlib figure."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    state = found.columns("state")
    time = state["stamp"] / NS
    figure = Figure(figsize=(WIDTH, 0.35 + HEIGHT * len(ROWS)), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(len(ROWS), 1, sharex=True)
    moved, unsafe = changes(found), spans(found)
    for axis, name in zip(axes, ROWS, strict=True):
        if name == "position":
            _reference(axis, found, scenario, time)
        _row(axis, name, state, time, scenario)
        mark(axis, moved)
        shade(axis, unsafe, time[-1])
        _dress(axis, name)
    axes[-1].set_xlim(0.0, time[-1])
    axes[-1].set_xlabel("time [s]", fontsize=8)
    figure.align_ylabels(axes)
    return figure


def _reference(axis: Any, found: Recording, scenario: Scenario, time: Any) -> None:
    line = followed(found, scenario, time)
    if np.isfinite(line).any():
        course = thinned(time, line * GROUPS["position"].scale, STRETCHES)
        axis.plot(course.time, course.mean, color=LIGHT["grey"], linestyle="--", linewidth=1.0, label="reference")


def _row(axis: Any, name: str, state: Mapping[str, Any], time: Any, scenario: Scenario) -> None:
    rig = scenario.rig_values()
    for curve in GROUPS[name].curves:
        course = thinned(time, state[curve.field] * GROUPS[name].scale, STRETCHES)
        colour = LIGHT[curve.colour]
        axis.fill_between(course.time, course.least, course.greatest, color=colour, alpha=0.22, linewidth=0.3)
        axis.plot(course.time, course.mean, color=colour, linewidth=0.9, label=of_drive(curve.label, rig))


def _dress(axis: Any, name: str) -> None:
    axis.grid(color="#d9dde3", linewidth=0.6)
    axis.spines[["top", "right"]].set_visible(False)
    axis.tick_params(labelsize=7, colors="#444")
    axis.set_ylabel(GROUPS[name].axis, fontsize=8)
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=7, frameon=False, ncols=6, borderpad=0.1)
