"""A relay's chart as picture, table and page."""

import json
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np

from bridge.drawing.html import text
from bridge.errors import writing
from bridge.studies.stability.chart_drawing import (
    COLOURS,
    WIDE,
    Overlay,
    fixed_words,
    run_words,
    write_runs,
    write_table,
)
from bridge.studies.stability.chart_page import PAGE
from bridge.studies.stability.relay_map import CLASSES, RelayChart, class_words, classes, plain

LINE = "#1f4e9c"
THEORY = "Colours: the reduced drive after a step of 2 mm (docs/stability.md)"
LEAD = "(5.22) with hold and delay:\nlead needed, T_d + delay + T/2"


def write_relay(chart: RelayChart, overlay: Overlay, base: Path) -> list[Path]:
    """BASE.png, BASE.csv, BASE.html; and BASE-runs.csv where there are runs."""
    picture, table, page = (base.with_name(f"{base.name}.{end}") for end in ("png", "csv", "html"))
    with writing(picture):
        draw_relay_chart(chart, overlay).savefig(picture)
    x, y = np.meshgrid(chart.x, chart.y)
    columns: dict[str, Any] = {chart.labels[0]: x, chart.labels[1]: y, "peak to peak [mm]": chart.peak}
    columns |= {"frequency [Hz]": chart.frequency, "derivative of (5.22) with hold and delay [ms]": chart.lead}
    write_table(table, columns | {name: np.full_like(x, value) for name, value in chart.fixed.items()})
    with writing(page):
        page.write_text(_html(chart, overlay), encoding="utf-8")
    return [picture, table, page, *write_runs(chart.labels, overlay, base)]


def draw_relay_chart(chart: RelayChart, overlay: Overlay) -> Any:
    """A matplotlib figure."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    from bridge.drawing.canvas import label, remark, sheet

    page, (axes,) = sheet(f"Swing of a sampled relay: {chart.about}")
    found, colours = classes(chart.peak), ListedColormap(COLOURS)
    norm = BoundaryNorm(np.arange(len(COLOURS) + 1) - 0.5, len(COLOURS))
    axes.pcolormesh(chart.x, chart.y, found, cmap=colours, norm=norm, shading="nearest", rasterized=True)
    keys: list[Any] = [Patch(color=COLOURS[n], label=class_words(n)) for n in np.unique(found).tolist()]
    keys += _line(axes, chart)
    for run in overlay.runs:
        own = COLOURS[int(classes(np.array([2e3 * run.amplitude]))[0])]
        axes.plot(run.x, run.y, "o", color=own, markeredgecolor="0.1", markersize=7)
    if overlay.runs:
        keys += axes.plot([], [], "o", color="w", markeredgecolor="0.1", markersize=7, label="run of the twin")
    label(axes, *chart.labels)
    axes.set(xlim=(chart.x[0], chart.x[-1]), ylim=(chart.y[0], chart.y[-1]))
    axes.legend(handles=keys, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    lines = [f"{THEORY}.{f' Circles: {overlay.words}.' if overlay.runs else ''}", fixed_words(chart)]
    remark(page, "\n".join(fill(line, WIDE) for line in lines))
    return page


def _line(axes: Any, chart: RelayChart) -> list[Any]:
    """Where the derivative time is what (5.22) asks for."""
    if "derivative" not in (chart.across, chart.up):
        return []
    across, up = np.meshgrid(chart.x, chart.y)
    beyond = (across if chart.across == "derivative" else up) - chart.lead
    if not beyond.min() < 0.0 < beyond.max():
        return []
    axes.contour(chart.x, chart.y, beyond, levels=[0.0], colors=LINE, linewidths=1.6)
    return axes.plot([], [], color=LINE, linewidth=1.6, label=LEAD)


def _html(chart: RelayChart, overlay: Overlay) -> str:
    data = plain(chart) | {
        "runs": [[run.x, run.y, int(run.oscillates), run_words(run, overlay.units)] for run in overlay.runs],
        "parted": [0] * len(overlay.runs),
        "colours": COLOURS,
    }
    page = PAGE.replace("@TITLE@", text(f"Swing of a sampled relay: {chart.about}"))
    page = page.replace("Colours: linear theory, multipliers counted.", text(f"{THEORY}."))
    page = page.replace("@RUNS@", text(f"Crosses swing by more than {CLASSES[0]:g} mm: runs of the twin."))
    return page.replace("@FIXED@", text(fixed_words(chart))).replace("@DATA@", json.dumps(data).replace("</", "<\\/"))
