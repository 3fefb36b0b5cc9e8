"""What a follower has estimated: with the band of its deviations, beside what the plant says is true where it does."""

from typing import Any

import numpy as np

from bridge.drawing.colours import LIGHT
from bridge.report.charts import canvas, finish
from bridge.report.subject import Run
from bridge.scenario.units import shown
from bridge.wire.estimates import DEVIATION, OF_UNKNOWN
from bridge.wire.messages import ESTIMATE
from controller.grid import NS
from twin.estimation.quantities import ESTIMATED, UNKNOWNS

PANELS = (  # quantities of one unit
    ("pressure", {"p_p": "violet", "p_lower": "blue", "p_upper": "orange"}),
    ("force", {"friction": "red", "load": "green"}),
)
WIDTH = 2.0  # deviations to either side
CAPTION = (
    "Lines: estimates of a twin beside the rig; bands: two standard deviations to either side; dotted: the true "
    "values, which the twin does not know. Factors are those of what is unknown of the rig, 1 as in its scenario."
)


def has_estimates(run: Run) -> bool:
    """Has somebody followed it?"""
    return bool(run.recording.counts.get(ESTIMATE))


def draw_estimates(run: Run) -> Any:
    """A matplotlib figure."""
    found = run.recording.columns(ESTIMATE)
    state = run.recording.columns("state") if run.recording.counts.get("state") else {}
    time = found["stamp"] / NS
    figure, axes = canvas(len(PANELS) + 1, 1.9)
    for axis, (what, names) in zip(axes, PANELS, strict=False):
        scale, unit = shown(ESTIMATED[next(iter(names))])
        for name, colour in names.items():
            _band(axis, time, scale * found[name], scale * found[name + DEVIATION], name, LIGHT[colour])
            if name in state:
                axis.plot(state["stamp"] / NS, scale * state[name], color="black", linewidth=0.6, linestyle=":")
        finish(axis, f"{what} [{unit}]", time[-1], last=False)
    factors = [name for name, unknown in UNKNOWNS.items() if not unknown.unit]
    for name, colour in zip(factors, list(LIGHT.values())[: len(factors)], strict=False):
        values = found[OF_UNKNOWN + name]
        if not np.isnan(values).all():
            _band(axes[-1], time, values, found[OF_UNKNOWN + name + DEVIATION], name, colour)
    finish(axes[-1], "factor", time[-1])
    return figure


def _band(axis: Any, time: Any, mean: Any, deviation: Any, label: str, colour: str) -> None:
    axis.fill_between(time, mean - WIDTH * deviation, mean + WIDTH * deviation, color=colour, alpha=0.22, linewidth=0.3)
    axis.plot(time, mean, color=colour, linewidth=1.1, label=label)
