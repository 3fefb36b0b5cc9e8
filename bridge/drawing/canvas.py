"""What all figures share: the sheet, its axes, and the shape of a table."""

from __future__ import annotations  # matplotlib is slow to import: only who draws pays for it

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Sheet
else:
    Axes = Sheet = object

Array = npt.NDArray[np.floating]
Columns = dict[str, Array]  # name with its unit in brackets -> values, all equally long

DOTS_PER_INCH = 150


def sheet(title: str, panels: int = 1) -> tuple[Sheet, list[Axes]]:
    """An empty sheet with a title and panels side by side."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    page = Figure(figsize=(9.0 if panels == 1 else 6.0 * panels, 5.0), dpi=DOTS_PER_INCH, layout="constrained")
    FigureCanvasAgg(page)
    page.suptitle(title, fontsize=12)
    return page, [_panel(page, panels, index) for index in range(panels)]


def stack(title: str, heights: Sequence[float]) -> tuple[Sheet, list[Axes]]:
    """An empty sheet with a title and panels above each other, on one horizontal axis; their heights as shares."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    page = Figure(figsize=(9.0, 1.2 + 1.8 * sum(heights)), dpi=DOTS_PER_INCH, layout="constrained")
    FigureCanvasAgg(page)
    page.suptitle(title, fontsize=12)
    panels = page.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=list(heights))[:, 0]
    return page, [_plain(axes) for axes in panels]


def tiles(title: str, rows: int, columns: int) -> tuple[Sheet, list[Axes]]:
    """An empty sheet with a title and panels in rows, in reading order."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    page = Figure(figsize=(4.0 * columns, 1.0 + 3.0 * rows), dpi=DOTS_PER_INCH, layout="constrained")
    FigureCanvasAgg(page)
    page.suptitle(title, fontsize=12)
    return page, [_plain(axes) for axes in page.subplots(rows, columns, squeeze=False).ravel()]


def lattice(title: str, rows: int, columns: int) -> tuple[Sheet, list[list[Axes]]]:
    """An empty sheet with a title and rows of panels that share their vertical axis in each row."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    page = Figure(figsize=(3.2 * columns, 0.6 + 3.0 * rows), dpi=DOTS_PER_INCH, layout="constrained")
    FigureCanvasAgg(page)
    page.suptitle(title, fontsize=12)
    panels = page.subplots(rows, columns, sharey="row", squeeze=False)
    return page, [[_plain(axes) for axes in row] for row in panels]


def drawing(width: float, height: float, bounds: tuple[float, float, float, float]) -> tuple[Sheet, Axes]:
    """An empty sheet [inch] without axes; bounds: left, right, bottom, top, of the same shape or drawn to fit."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    page = Figure(figsize=(width, height), dpi=DOTS_PER_INCH)
    FigureCanvasAgg(page)
    axes = page.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(*bounds[:2])
    axes.set_ylim(*bounds[2:])
    axes.set_aspect("equal")
    return page, axes


def remark(page: Sheet, text: str) -> None:
    """A line below the panels."""
    page.supxlabel(text, fontsize=8, color="0.35", x=0.01, ha="left")


def _panel(page: Sheet, panels: int, index: int) -> Axes:
    return _plain(page.add_subplot(1, panels, index + 1))


def _plain(axes: Axes) -> Axes:
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    return axes


def label(axes: Axes, across: str, up: str) -> None:
    """Name both axes, unit included."""
    axes.set_xlabel(across)
    axes.set_ylabel(up)


def shades(values: Sequence[float]) -> list[tuple[float, float, float, float]]:
    """A colour for each of some ordered values, dark to bright; told apart in grey as well."""
    from matplotlib import colormaps

    return [colormaps["plasma"](share) for share in np.linspace(0.0, 0.85, len(values))]
