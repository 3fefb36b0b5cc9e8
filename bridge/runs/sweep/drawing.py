"""A sweep as a picture: a curve per metric over one axis, a map per metric over two, a row of maps over three."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bridge.drawing.canvas import Axes, Sheet, label, remark, stack, tiles
from bridge.errors import writing
from bridge.runs.sweep.axes import Axis
from bridge.runs.sweep.sweep import Found, Row

if TYPE_CHECKING:
    from bridge.runs.sweep.theory import TheoryEdge

MOST_FACETS = 6
BEST, FAILED, THEORY = "#1f6b39", "#a3231f", "#1c2430"
TOO_MANY = (
    f"no picture: it shows two axes, and a third of at most {MOST_FACETS} values; the table has everything, and "
    "--set NAME=VALUE takes an axis out"
)


def can_draw(axes: list[Axis]) -> bool:
    """Is there a picture of so many axes?"""
    return len(axes) <= 2 or (len(axes) == 3 and len(axes[2].texts) <= MOST_FACETS)


def write_picture(found: Found, edge: TheoryEdge | None, path: Path) -> Path:
    """Draw and write. For axes that `can_draw`."""
    page = _curves(found, edge) if len(found.wanted.axes) == 1 else _maps(found, edge)
    with writing(path):
        page.savefig(path)
    return path


def _title(found: Found) -> str:
    return f"{found.wanted.scenario.name}: {len(found.rows)} runs"


def _places(axis: Axis) -> tuple[np.ndarray, bool]:
    """Where the values stand, and whether they stand as numbers: words stand one after the other."""
    if axis.numbers is None:
        return np.arange(len(axis.texts), dtype=float), False
    return np.array(axis.numbers), True


def _dress(along: Any, axis: Axis, numeric: bool, name: str) -> None:
    """Ticks of words, and a scale of even ratios."""
    if not numeric:
        getattr(along, f"set_{name}ticks")(range(len(axis.texts)), labels=axis.texts)
    elif axis.even_ratios:
        getattr(along, f"set_{name}scale")("log")


def _column(rows: list[Row], column: int, factor: float) -> np.ndarray:
    return np.array([np.nan if (v := row.values[column]) is None else v * factor for row in rows])


def _curves(found: Found, edge: TheoryEdge | None) -> Sheet:
    axis, asked = found.wanted.axes[0], found.wanted.measures
    page, panels = stack(_title(found), [1.2] * len(asked))
    x, numeric = _places(axis)
    order, failed = np.argsort(x), np.array([bool(row.reason) for row in found.rows])
    for column, (panel, one) in enumerate(zip(panels, asked, strict=True)):
        y = _column(found.rows, column, one.factor)
        panel.plot(x[order], y[order], ".-" if numeric else "o")
        panel.plot(x[failed], np.full(failed.sum(), 0.03), "x", color=FAILED, transform=panel.get_xaxis_transform())
        if (best := found.best(column)) is not None:
            panel.plot(x[best], y[best], "o", color=BEST, fillstyle="none", markersize=10)
        if edge is not None and np.isfinite(edge.gains[0]) and edge.gains[0] <= 1.05 * x.max():
            panel.axvline(edge.gains[0], color=THEORY, linestyle="--", linewidth=1.0)
        panel.set_ylabel(one.label.replace(" from ", "\nfrom "), fontsize=9)
    _dress(panels[-1], axis, numeric, "x")
    panels[-1].set_xlabel(axis.label)
    remark(page, _words(found, edge))
    return page


def _maps(found: Found, edge: TheoryEdge | None) -> Sheet:
    """Rows of metrics; of three axes a column for each value of the third."""
    axes, asked = found.wanted.axes, found.wanted.measures
    facets = list(range(len(axes[2].texts))) if len(axes) == 3 else [None]
    across = len(facets) if facets != [None] else min(3, len(asked))
    down = len(asked) if facets != [None] else -(-len(asked) // across)
    page, panels = tiles(_title(found), down, across)
    shown = [(column, facet) for column in range(len(asked)) for facet in facets]
    for panel, (column, facet) in zip(panels, shown, strict=False):
        _map(panel, found, column, facet, edge)
    for panel in panels[len(shown) :]:
        panel.set_axis_off()
    remark(page, _words(found, edge))
    return page


def _map(panel: Axes, found: Found, column: int, facet: int | None, edge: TheoryEdge | None) -> None:
    across, up = found.wanted.axes[:2]
    one = found.wanted.measures[column]
    rows = [row for row in found.rows if facet is None or row.places[2] == facet]
    (x, x_numeric), (y, y_numeric) = _places(across), _places(up)
    values = _column(rows, column, one.factor).reshape(len(x), len(y)).T
    i, j = np.argsort(x), np.argsort(y)
    known = [value * one.factor for row in found.rows if (value := row.values[column]) is not None]
    ends: Any = {"vmin": min(known), "vmax": max(known)} if known else {}  # the same for all values of a third axis
    mesh = panel.pcolormesh(x[i], y[j], values[j][:, i], shading="nearest", cmap="viridis", **ends)
    panel.figure.colorbar(mesh, ax=panel)
    failed = [row.places for row in rows if row.reason]
    panel.plot([x[a] for a, *_ in failed], [y[b] for _, b, *_ in failed], "x", color=FAILED)
    best = found.best(column)
    if best is not None and (facet is None or found.rows[best].places[2] == facet):
        a, b, *_ = found.rows[best].places
        for colour, width in (("white", 4.0), (BEST, 2.0)):
            panel.plot(x[a], y[b], "o", color=colour, markersize=8, fillstyle="none", markeredgewidth=width)
    _draw_edge(panel, edge)
    for axis, numeric, name in ((across, x_numeric, "x"), (up, y_numeric, "y")):
        _dress(panel, axis, numeric, name)
    where = "" if facet is None else f"\n{found.wanted.axes[2].name} = {found.wanted.axes[2].texts[facet]}"
    panel.set_title(one.label + where, fontsize=9)
    label(panel, across.label, up.label)


def _draw_edge(panel: Axes, edge: TheoryEdge | None) -> None:
    """The line of the theory, within the map."""
    if edge is None or not edge.places:
        return
    limits = panel.get_xlim(), panel.get_ylim()
    pair = (edge.gains, edge.places) if edge.gain == 0 else (edge.places, edge.gains)
    panel.plot(*pair, "--", color=THEORY, linewidth=1.4)
    panel.set(xlim=limits[0], ylim=limits[1])


def _words(found: Found, edge: TheoryEdge | None) -> str:
    marks = ["Ring: the smallest."]
    marks += ["Cross: the run failed."] if found.ran < len(found.rows) else []
    marks += [f"Dashed: {edge.words}."] if edge is not None else []
    return " ".join(marks)
