"""What a follower has estimated: with the band of its deviations, beside what the plant says is true where it does."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from bridge.drawing.colours import LIGHT
from bridge.drawing.html import table
from bridge.recording.innovations import missed
from bridge.report.charts import canvas, finish
from bridge.report.subject import Run
from bridge.scenario.units import shown
from bridge.wire.estimates import DEVIATION, OF_UNKNOWN
from bridge.wire.messages import ESTIMATE, INNOVATION
from controller.grid import NS
from twin.estimation.quantities import ESTIMATED, UNKNOWNS, Use
from twin.topology import CHANNELS

PANELS = (  # quantities of one unit
    ("pressure", {"p_p": "violet", "p_lower": "blue", "p_upper": "orange"}),
    ("force", {"friction": "red", "load": "green"}),
)
COLOURS = ("blue", "orange", "green")
TOGETHER = len(COLOURS)  # unknowns in one picture: bands of more hide one another
WIDTH = 2.0  # deviations to either side
CAPTION = (
    "Lines: estimates of a twin beside the rig; bands: two standard deviations to either side; dotted: the true "
    "values, which the twin does not know. Factors are those of what is unknown of the rig, 1 as in its scenario; "
    "load_force is a force beside the weight."
)
INNOVATIONS = (
    "Reading less what the twin expected of it, where it follows. A channel that it does not use says how well it is "
    "found without its sensor."
)


def has_estimates(run: Run) -> bool:
    """Has somebody followed it?"""
    return bool(run.recording.counts.get(ESTIMATE))


def draw_estimates(run: Run) -> Any:
    """A matplotlib figure."""
    found = run.recording.columns(ESTIMATE)
    state = run.recording.columns("state") if run.recording.counts.get("state") else {}
    time, groups = found["stamp"] / NS, [*unknown_groups(found)]
    figure, axes = canvas(len(PANELS) + len(groups), 1.6)
    for axis, (what, names) in zip(axes, PANELS, strict=False):
        scale, unit = shown(ESTIMATED[next(iter(names))])
        for name, colour in names.items():
            _band(axis, time, scale * found[name], scale * found[name + DEVIATION], name, LIGHT[colour])
            if name in state:
                axis.plot(state["stamp"] / NS, scale * state[name], color="black", linewidth=0.6, linestyle=":")
        finish(axis, f"{what} [{unit}]", time[-1], last=False)
    for axis, (unit, names) in zip(axes[len(PANELS) :], groups, strict=True):
        scale, words = shown(unit) if unit else (1.0, "")
        for name, colour in zip(names, COLOURS, strict=False):
            mean, deviation = found[OF_UNKNOWN + name], found[OF_UNKNOWN + name + DEVIATION]
            _band(axis, time, scale * mean, scale * deviation, name, LIGHT[colour])
        finish(axis, f"[{words}]" if unit else "factor", time[-1], last=axis is axes[-1])
    return figure


def unknown_groups(found: Mapping[str, Any]) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Unit and names of unknowns that are estimated: those of one unit, a few at a time."""
    estimated = [name for name in UNKNOWNS if not np.isnan(found[OF_UNKNOWN + name]).all()]
    for unit in dict.fromkeys(UNKNOWNS[name].unit for name in estimated):
        names = tuple(name for name in estimated if UNKNOWNS[name].unit == unit)
        yield from ((unit, names[first : first + TOGETHER]) for first in range(0, len(names), TOGETHER))


def innovations_table(run: Run) -> str:
    """How far each channel lay from what was expected of it, in HTML."""
    rows = []
    for name, one in missed(run.recording).items():
        if one.scans:
            scale, unit = shown(CHANNELS[name].unit)
            rows.append((name, _uses(run, name), f"{scale * one.rms:.3g} {unit}", f"{one.deviations:.2g}"))
    head = ("channel", "use", "rms of reading less prediction", "in deviations that are stated of it")
    return f"{table(head, rows, 'numbers')}<p class='soft'>{INNOVATIONS}</p>" if rows else ""


def _uses(run: Run, name: str) -> str:
    """What is made of a channel most of the time."""
    uses = run.recording.columns(INNOVATION)[f"{name}_use"]
    values, counts = np.unique(uses, return_counts=True)
    use = Use(int(values[np.argmax(counts)]))
    return "not used" if use is Use.MISSING else use.name.lower()


def _band(axis: Any, time: Any, mean: Any, deviation: Any, label: str, colour: str) -> None:
    axis.fill_between(time, mean - WIDTH * deviation, mean + WIDTH * deviation, color=colour, alpha=0.22, linewidth=0.3)
    axis.plot(time, mean, color=colour, linewidth=1.1, label=label)
