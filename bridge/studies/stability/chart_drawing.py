"""A chart of stability as picture, table and page."""

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple, Protocol

import numpy as np

from bridge.drawing.html import text
from bridge.errors import writing
from bridge.studies.stability.chart import Chart
from bridge.studies.stability.chart_page import PAGE
from bridge.studies.stability.equivalent import Scaled
from bridge.studies.stability.mark import draw_mark, mark_words
from controller.stability.actuator.disagreement import CAUSES

COLOURS = ("#cfe3d4", "#f6d9a8", "#eeb08f", "#d98a86", "#b9677c")  # none, one, two .. multipliers not inside
GOOD, BAD, RING = "#1f6b39", "#a3231f", "#1c2430"
WIDE = 150  # letters of a line of a remark
RINGS = {"hard": "o", "saturated": "s", "slow": "v", "damped": "^", "unexplained": "p"}


class ChartRun(NamedTuple):
    """One run laid over a chart."""

    x: float
    y: float
    oscillates: bool
    frequency: float  # [Hz], or rad a unit of time
    amplitude: float  # [m], or chamber lengths
    saturated: float | None  # share of samples that found the valve at its limit; None: not asked
    cause: str | None  # why it and theory disagree, of CAUSES; "": it does not; None: not asked


class Fixed(Protocol):
    """A chart with numbers that are not on an axis, by their label."""

    @property
    def fixed(self) -> dict[str, float]: ...


class Overlay(NamedTuple):
    """Runs laid over a chart, and what they are runs of."""

    runs: Sequence[ChartRun]
    words: str
    units: tuple[str, str]  # of frequency and amplitude


NOTHING = Overlay((), "", ("", ""))


def write(chart: Chart, overlay: Overlay, base: Path, marked: Scaled | None = None) -> list[Path]:
    """BASE.png, BASE.csv, BASE.html; and BASE-runs.csv where there are runs. The numbers of a rig may be marked."""
    picture, table, page = (base.with_name(f"{base.name}.{end}") for end in ("png", "csv", "html"))
    with writing(picture):
        draw(chart, overlay, marked).savefig(picture)
    x, y = np.meshgrid(chart.x, chart.y)
    columns = {chart.labels[0]: x, chart.labels[1]: y, "stable multipliers": chart.total - chart.outside}
    columns |= {
        "of": chart.total,
        "not inside": chart.outside,
        "largest less 1": chart.excess,
        "angle [rad]": chart.angle,
    }
    columns |= {name: np.full_like(x, value) for name, value in chart.fixed.items()}
    write_table(table, columns)
    with writing(page):
        page.write_text(html(chart, overlay, marked), encoding="utf-8")
    return [picture, table, page, *write_runs(chart.labels, overlay, base)]


def write_runs(labels: tuple[str, str], overlay: Overlay, base: Path) -> list[Path]:
    """BASE-runs.csv where there are runs."""
    if not overlay.runs:
        return []
    beside = base.with_name(f"{base.name}-runs.csv")
    names = (*labels, *ChartRun._fields[2:])
    asked = {
        name: column for name, column in zip(names, zip(*overlay.runs, strict=True), strict=True) if None not in column
    }
    write_table(beside, {name: np.array(column) for name, column in asked.items()})
    return [beside]


def write_table(path: Path, columns: dict[str, Any]) -> None:
    """A CSV file of columns that are equally long."""
    with writing(path), path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(columns)
        rows.writerows(map(_cell, row) for row in zip(*(c.ravel() for c in columns.values()), strict=True))


def _cell(value: Any) -> str:
    return str(value) if isinstance(value, str) else f"{value:.9g}"


def draw(chart: Chart, overlay: Overlay, marked: Scaled | None = None) -> Any:
    """A matplotlib figure."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    from bridge.drawing.canvas import label, remark, sheet

    page, (axes,) = sheet(f"Stability of the sampled loop: {chart.about}")
    counted, colours = np.minimum(chart.outside, len(COLOURS) - 1), ListedColormap(COLOURS)
    norm = BoundaryNorm(np.arange(len(COLOURS) + 1) - 0.5, len(COLOURS))
    axes.pcolormesh(chart.x, chart.y, counted, cmap=colours, norm=norm, shading="nearest", rasterized=True)
    if counted.min() == 0 < counted.max():
        axes.contour(chart.x, chart.y, counted > 0, levels=[0.5], colors=GOOD, linewidths=1.6)
    keys: list[Any] = [Patch(color=COLOURS[n], label=_outside_words(n)) for n in np.unique(counted).tolist()]
    keys += _marks(axes, overlay.runs)
    label(axes, *chart.labels)
    axes.set(xlim=(chart.x[0], chart.x[-1]), ylim=(chart.y[0], chart.y[-1]))
    keys += [draw_mark(axes, marked, chart.across, chart.up)] if marked else []
    axes.legend(handles=keys, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    about = f" Marks: {overlay.words}." if overlay.runs else ""
    lines = [f"Colours and line: linear theory.{about}".replace(". A run", ".\nA run"), fixed_words(chart)]
    remark(page, "\n".join(fill(line, WIDE) for line in [*lines, *_mark_lines(chart, marked)]))
    return page


def fixed_words(chart: Fixed) -> str:
    """The numbers that are not on an axis."""
    return f"Fixed: {', '.join(f'{name} = {value:.4g}' for name, value in chart.fixed.items())}."


def _mark_lines(chart: Chart, marked: Scaled | None) -> list[str]:
    if marked is None:
        return []
    ranges = tuple((float(axis[0]), float(axis[-1])) for axis in (chart.x, chart.y))
    return [f"{mark_words(marked, chart.across, chart.up, (ranges[0], ranges[1]), chart.numbers)}."]


def _marks(axes: Any, runs: Sequence[ChartRun]) -> list[Any]:
    """Draw the runs; what the legend needs."""
    kinds = [("run dies away", GOOD, "o", [run for run in runs if not run.oscillates])]
    kinds += [("run oscillates", BAD, "x", [run for run in runs if run.oscillates and not run.saturated])]
    kinds += [
        ("run oscillates, valve at its limit", BAD, "P", [run for run in runs if run.oscillates and run.saturated])
    ]
    for cause in sorted({run.cause for run in runs if run.cause}):
        kinds += [(f"disagrees with theory: {cause}", RING, RINGS[cause], [run for run in runs if run.cause == cause])]
    keys = []
    for words, colour, marker, chosen in kinds:
        if chosen:
            ring = {"markersize": 9, "fillstyle": "none"} if colour == RING else {"markersize": 4}
            across, up = [run.x for run in chosen], [run.y for run in chosen]
            keys.append(axes.plot(across, up, marker, color=colour, linestyle="", label=words, **ring)[0])
    return keys


def _outside_words(count: int) -> str:
    more = " or more" if count == len(COLOURS) - 1 else ""
    return "stable: all multipliers inside" if count == 0 else f"{count}{more} on or outside the unit circle"


def html(chart: Chart, overlay: Overlay, marked: Scaled | None = None) -> str:
    """A page that needs nothing else, with a readout under the pointer."""
    data = {
        "x": chart.x.tolist(),
        "y": chart.y.tolist(),
        "labels": chart.labels,
        "outside": chart.outside.tolist(),
        "total": chart.total.tolist(),
        "size": np.round(chart.excess + 1.0, 6).tolist(),
        "angle": np.round(chart.angle, 6).tolist(),
        "runs": [[run.x, run.y, int(run.oscillates), run_words(run, overlay.units)] for run in overlay.runs],
        "parted": [int(bool(run.cause)) for run in overlay.runs],
        "colours": COLOURS,
        "words": [_outside_words(n) for n in range(len(COLOURS))],
    }
    marks = (
        f"Dots die away, crosses oscillate: {overlay.words}. In a ring: run and theory part; point there for the cause."
    )
    page = PAGE.replace("@TITLE@", text(f"Stability of the sampled loop: {chart.about}"))
    page = page.replace("@RUNS@", text(marks) if overlay.runs else "")
    page = page.replace("@FIXED@", text(" ".join([fixed_words(chart), *_mark_lines(chart, marked)])))
    return page.replace("@DATA@", json.dumps(data).replace("</", "<\\/"))


def run_words(run: ChartRun, units: tuple[str, str]) -> str:
    """What a run did, for a person."""
    swing = f"oscillates at {run.frequency:.4g} {units[0]}, amplitude {run.amplitude:.3g} {units[1]}"
    swing = swing if run.oscillates else "dies away"
    limit = f", the valve at its limit for {100.0 * run.saturated:.0f} % of the samples" if run.saturated else ""
    return f"{swing}{limit}{f'. It disagrees with theory: {CAUSES[run.cause]}' if run.cause else ''}"
