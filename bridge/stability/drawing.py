"""A chart of stability as picture, table and page."""

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bridge.report.inline import text
from bridge.stability.chart import Chart
from bridge.stability.page import PAGE

COLOURS = ("#cfe3d4", "#f6d9a8", "#eeb08f", "#d98a86", "#b9677c")  # none, one, two .. multipliers not inside
GOOD, BAD = "#1f6b39", "#a3231f"


class Run(NamedTuple):
    """One run laid over a chart."""

    x: float
    y: float
    oscillates: bool
    frequency: float  # [Hz], or cycles a unit of time


def write(chart: Chart, runs: Sequence[Run], base: Path) -> list[Path]:
    """BASE.png, BASE.csv, BASE.html; and BASE-runs.csv where there are runs."""
    base.parent.mkdir(parents=True, exist_ok=True)
    picture, table, page = (base.with_name(f"{base.name}.{end}") for end in ("png", "csv", "html"))
    draw(chart, runs).savefig(picture)
    x, y = np.meshgrid(chart.x, chart.y)
    columns = {chart.labels[0]: x, chart.labels[1]: y, "stable multipliers": chart.total - chart.outside}
    columns |= {
        "of": chart.total,
        "not inside": chart.outside,
        "largest less 1": chart.excess,
        "angle [rad]": chart.angle,
    }
    _table(table, columns)
    page.write_text(html(chart, runs), encoding="utf-8")
    if not runs:
        return [picture, table, page]
    beside = base.with_name(f"{base.name}-runs.csv")
    names = (*chart.labels, "oscillates", "frequency")
    _table(beside, dict(zip(names, np.array(runs, float).T, strict=True)))
    return [picture, table, page, beside]


def _table(path: Path, columns: dict[str, Any]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(columns)
        rows.writerows([f"{v:.9g}" for v in row] for row in zip(*(c.ravel() for c in columns.values()), strict=True))


def draw(chart: Chart, runs: Sequence[Run]) -> Any:
    """A matplotlib figure."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    from bridge.figures.canvas import label, remark, sheet

    page, (axes,) = sheet(f"Stability of the sampled loop: {chart.about}")
    counted, colours = np.minimum(chart.outside, len(COLOURS) - 1), ListedColormap(COLOURS)
    norm = BoundaryNorm(np.arange(len(COLOURS) + 1) - 0.5, len(COLOURS))
    axes.pcolormesh(chart.x, chart.y, counted, cmap=colours, norm=norm, shading="nearest", rasterized=True)
    if counted.min() == 0 < counted.max():
        axes.contour(chart.x, chart.y, counted > 0, levels=[0.5], colors=GOOD, linewidths=1.6)
    keys: list[Any] = [Patch(color=COLOURS[n], label=_outside_words(n)) for n in np.unique(counted).tolist()]
    for oscillates, colour, marker, words in ((False, GOOD, "o", "run dies away"), (True, BAD, "x", "run oscillates")):
        if chosen := [run for run in runs if run.oscillates is oscillates]:
            across, up = [run.x for run in chosen], [run.y for run in chosen]
            keys.append(axes.plot(across, up, marker, color=colour, markersize=4, linestyle="", label=words)[0])
    label(axes, *chart.labels)
    axes.set(xlim=(chart.x[0], chart.x[-1]), ylim=(chart.y[0], chart.y[-1]))
    axes.legend(handles=keys, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    remark(page, "Colours and line: linear theory. Marks: runs of the full model.")
    return page


def _outside_words(count: int) -> str:
    more = " or more" if count == len(COLOURS) - 1 else ""
    return "stable: all multipliers inside" if count == 0 else f"{count}{more} on or outside the unit circle"


def html(chart: Chart, runs: Sequence[Run]) -> str:
    """A page that needs nothing else, with a readout under the pointer."""
    data = {
        "x": chart.x.tolist(),
        "y": chart.y.tolist(),
        "labels": chart.labels,
        "outside": chart.outside.tolist(),
        "total": chart.total.tolist(),
        "size": np.round(chart.excess + 1.0, 6).tolist(),
        "angle": np.round(chart.angle, 6).tolist(),
        "runs": [[run.x, run.y, int(run.oscillates), run.frequency] for run in runs],
        "colours": COLOURS,
        "words": [_outside_words(n) for n in range(len(COLOURS))],
    }
    return PAGE.replace("@TITLE@", text(f"Stability of the sampled loop: {chart.about}")).replace(
        "@DATA@", json.dumps(data).replace("</", "<\\/")
    )
