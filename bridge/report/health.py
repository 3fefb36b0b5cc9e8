"""What a follower has made of the health of a rig: how far each hypothesis has gone, and the limit of an alarm."""

from typing import Any

import numpy as np

from bridge.drawing.colours import LIGHT
from bridge.recording.verdicts import verdicts_of
from bridge.report.charts import canvas, finish
from bridge.report.subject import Run
from bridge.wire.health import DEVIATE, PLACES
from bridge.wire.messages import HEALTH
from controller.grid import NS

QUIET = 3.0  # deviates beyond which a hypothesis has a colour of its own


def has_health(run: Run) -> bool:
    """Has somebody judged it?"""
    return bool(run.recording.counts.get(HEALTH))


def draw_health(run: Run) -> Any:
    """A matplotlib figure."""
    found = run.recording.columns(HEALTH)
    time, colours = found["stamp"] / NS, iter(LIGHT.values())
    figure, (axis, *_) = canvas(1, 2.4)
    for name in PLACES:
        values = found[name + DEVIATE]
        loud = np.nanmax(np.abs(values), initial=0.0) > QUIET
        colour, label = (next(colours, "black"), name) if loud else ("lightgrey", None)
        axis.plot(time, values, color=colour, label=label, linewidth=1.1 if loud else 0.7, zorder=2.0 + loud)
    for side in (-1.0, 1.0):
        label = "limit" if side > 0.0 else None
        axis.plot(time, side * found["limit"], color="black", linewidth=0.6, linestyle=":", label=label)
    axis.set_yscale("symlog", linthresh=10.0)
    finish(axis, "normal deviate", time[-1])
    return figure


def caption_of(run: Run) -> str:
    """What the lines are, and the verdicts one after the other."""
    said = [f"{said.stamp / NS:g} s {said.words}" for said in verdicts_of(run.recording)]
    return (
        f"How far what each fault moves has gone from its baseline; grey: less than {QUIET:g}; dotted: the limit of an "
        f"alarm. {'; '.join(said)}."
    )
