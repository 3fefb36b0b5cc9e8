"""The report's chart of stability: the run's gain among the stable gains of its loop, over the sampling interval."""

from typing import Any

import numpy as np

from bridge.drawing.colours import LIGHT
from bridge.drawing.html import text
from bridge.report.charts import RUNS, canvas
from bridge.report.subject import Run
from bridge.studies.stability.operating import CHARTED, OperatingPoint, edge_curves, operating_point, sentences
from bridge.studies.stability.sampled_law import FACTOR
from controller.stability.amplitude.swing import WIDE

CAPTION = (
    f"By the theory of the reduced drive, with friction, saturation and card, after steps of {CHARTED * 1e3:g} mm: "
    f"below the lower line the loop settles, between the lines it hunts by up to {WIDE * 1e3:g} mm peak to peak, above "
    "the upper line it may swing by more. The dot is the run."
)


def stability_points(runs: list[Run]) -> list[OperatingPoint | None]:
    """The operating point of each run; None where there is no theory for its loop."""
    return [operating_point(run.scenario, run.summary.metrics) for run in runs]


def draw_stability(runs: list[Run], points: list[OperatingPoint | None]) -> Any:
    """A matplotlib figure: edges of the first run that has any, and one dot per run; None without a run.

    A law given as matrices has none: they are for one sampling period.
    """
    of_gains = ((run, point) for run, point in zip(runs, points, strict=True) if point and point.unit != FACTOR)
    known = list(of_gains)
    if not known:
        return None
    intervals, edges = edge_curves(known[0][0].scenario)
    figure, (axis,) = canvas(1, 2.8)
    top = 1.25 * max([*edges[np.isfinite(edges)].tolist(), *(point.gain for _, point in known)])
    axis.fill_between(intervals * 1e3, 0.0, edges[:, 0], color=LIGHT["blue"], alpha=0.12, linewidth=0.0)
    axis.fill_between(intervals * 1e3, edges[:, 0], edges[:, 1], color=LIGHT["grey"], alpha=0.25, linewidth=0.0)
    axis.plot(intervals * 1e3, edges[:, 0], color=LIGHT["blue"], linewidth=1.2, label="settles below")
    axis.plot(
        intervals * 1e3,
        edges[:, 1],
        color=LIGHT["red"],
        linewidth=1.2,
        label=f"swings by more than {WIDE * 1e3:g} mm above",
    )
    for (run, point), colour in zip(known, RUNS * len(known), strict=False):
        place = point.sample_period * 1e3, point.gain
        axis.plot(*place, "o", color=colour, markeredgecolor="white", markersize=8, label=run.name)
    bottom = 0.7 * min(float(np.min(edges)), *(point.gain for _, point in known))
    axis.set(xscale="log", yscale="log", ylim=(max(bottom, 1e-3), top), xlim=(intervals[0] * 1e3, intervals[-1] * 1e3))
    ticks = [t for t in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000) if intervals[0] <= t * 1e-3 <= intervals[-1]]
    axis.set_xticks(ticks, labels=[f"{t}" for t in ticks])
    rises = [g for g in (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20) if bottom <= g <= top]
    axis.set_yticks(rises, labels=[f"{g:g}" for g in rises])
    axis.minorticks_off()
    axis.set_xlabel("sampling interval [ms]", fontsize=9)
    axis.set_ylabel(f"gain [{known[0][1].unit}]", fontsize=9)
    axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, frameon=False, ncols=6, borderpad=0.1)
    return figure


def words(runs: list[Run], names: list[str], points: list[OperatingPoint | None]) -> str:
    """One paragraph per run."""
    parts = []
    for name, point in zip(names, points, strict=True):
        lines = sentences(point) if point is not None else []
        if lines:
            lead = f"<b>{text(name)}</b>: " if len(runs) > 1 else ""
            parts.append(f"<p>{lead}{text('. '.join(line[0].upper() + line[1:] for line in lines))}.</p>")
    return "".join(parts)
