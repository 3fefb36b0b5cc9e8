"""Symbols of a hydraulic circuit on a sheet without axes, after ISO 1219 where it has one."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from bridge.drawing.canvas import Axes

STEEL, HOSE, INK, OIL, PALE = "#3b4a5a", "#d9822b", "#222222", "#cfe3f5", "#f3f5f7"
Points = Sequence[tuple[float, float]]
SPOOL, BOX = "spool", 1.1  # the boxes of the directional valve, as a part, and how wide each is


@contextmanager
def part_of(axes: Axes, name: str) -> Iterator[None]:
    """What is drawn inside belongs to a part of the picture: its ids in SVG are NAME.1, NAME.2 and so on."""
    before = set(axes.get_children())
    yield
    drawn = [child for child in axes.get_children() if child not in before]
    taken = sum(str(child.get_gid() or "").startswith(f"{name}.") for child in before)
    for number, child in enumerate(drawn, taken + 1):
        child.set_gid(f"{name}.{number}")


def pipe(axes: Axes, route: Points, hose: bool) -> None:
    """A line of the circuit: steel plain, a hose with its braid."""
    x, y = zip(*route, strict=True)
    colour, width = (HOSE, 5.0) if hose else (STEEL, 3.2)
    axes.plot(x, y, color=colour, linewidth=width, solid_joinstyle="round", solid_capstyle="butt", zorder=2)
    if hose:
        axes.plot(x, y, color="white", linewidth=1.4, linestyle=(0, (2.2, 1.6)), zorder=2.1)


def thin(axes: Axes, *route: tuple[float, float], dashed: bool = False, width: float = 1.4) -> None:
    """A thin line through some points."""
    x, y = zip(*route, strict=True)
    axes.plot(x, y, color=INK, linewidth=width, linestyle=(0, (3, 2)) if dashed else "-", zorder=4.5)


def text(axes: Axes, x: float, y: float, words: str, colour: str = INK, size: float = 9.0, ha: str = "center") -> None:
    """Words at a point."""
    axes.text(x, y, words, color=colour, fontsize=size, ha=ha, va="center", linespacing=1.25, zorder=6)


def shape(axes: Axes, corners: Points, fill: str = "white", **style: Any) -> None:
    """A closed shape."""
    from matplotlib.patches import Polygon

    axes.add_patch(Polygon(list(corners), closed=True, facecolor=fill, edgecolor=INK, linewidth=1.4, zorder=4, **style))


def box(axes: Axes, x: float, y: float, width: float, height: float, fill: str = "white", **style: Any) -> None:
    """A rectangle from its lower left corner."""
    shape(axes, ((x, y), (x + width, y), (x + width, y + height), (x, y + height)), fill, **style)


def circle(axes: Axes, x: float, y: float, radius: float, fill: str = "white") -> None:
    """A circle around a point."""
    from matplotlib.patches import Circle

    axes.add_patch(Circle((x, y), radius, facecolor=fill, edgecolor=INK, linewidth=1.4, zorder=4))


def arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str = INK) -> None:
    """An arrow from point to point."""
    from matplotlib.patches import FancyArrowPatch

    style: dict[str, Any] = {"arrowstyle": "-|>", "mutation_scale": 11.0, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.add_patch(FancyArrowPatch(start, end, color=colour, linewidth=1.4, zorder=5, **style))


def dot(axes: Axes, x: float, y: float) -> None:
    """Where lines meet."""
    axes.plot([x], [y], "o", color=INK, markersize=6.5, zorder=5)


def spring(axes: Axes, x: float, y: float, width: float) -> None:
    """A spring to the right of a point."""
    turns = np.arange(7)
    axes.plot(x + width * turns / 6.0, y + 0.14 * np.array([0, 1, -1, 1, -1, 1, 0]), color=INK, linewidth=1.2, zorder=4)


def tank(axes: Axes, x: float, y: float) -> None:
    """An open tank whose edge is at a height."""
    sides, rim, floor = (x - 0.42, x + 0.42), y + 0.05, y - 0.35
    axes.plot([sides[0], *sides, sides[1]], [rim, floor, floor, rim], color=INK, linewidth=1.6, zorder=3)
    axes.fill_between(sides, floor, y - 0.12, color=OIL, linewidth=0.0, zorder=1)


def fittings(axes: Axes, has_filter: bool, has_valve: bool) -> None:
    """Filter and two-position valve in line 2."""
    if has_filter:
        _filter(axes)
    if has_valve:
        _two_position_valve(axes)


def _filter(axes: Axes) -> None:
    shape(axes, ((4.95, 3.7), (5.3, 4.05), (5.65, 3.7), (5.3, 3.35)))
    thin(axes, (5.3, 4.05), (5.3, 3.35), dashed=True)
    text(axes, 5.3, 4.3, "filter", size=8.5)


def _two_position_valve(axes: Axes) -> None:
    box(axes, 6.3, 3.4, 0.6, 0.6)
    box(axes, 6.9, 3.4, 0.6, 0.6)
    arrow(axes, (6.3, 3.7), (6.9, 3.7))
    for side in (6.98, 7.42):
        thin(axes, (side, 3.58), (side, 3.82))
    text(axes, 6.9, 4.28, "two-position valve", size=8.5)


def directional_valve(axes: Axes, kind: str, moves: tuple[str, str] = ("lowers", "lifts")) -> None:
    """4/3: parallel arrows lower, crossed ones lift; the centre shut as in the proportional valve."""
    left, low, size = 7.65, 4.8, BOX
    with part_of(axes, SPOOL):
        _boxes(axes, left, low, size)
    for x, y, name in ((8.68, 4.58, "P"), (9.92, 4.58, "T"), (8.68, 6.12, "B"), (9.92, 6.12, "A")):
        text(axes, x, y, name, size=10.0)
    text(axes, left + 0.95, 6.85, f"directional valve\n{kind}", ha="right", size=8.5)
    text(axes, left + 0.5, 4.47, moves[0], size=8.5, colour="0.35")
    text(axes, left + 2.85, 4.47, moves[1], size=8.5, colour="0.35")


def _boxes(axes: Axes, left: float, low: float, size: float) -> None:
    for index in range(3):
        box(axes, left + size * index, low, size, size, PALE if index == 1 else "white")
    high, near, far = low + size, 0.15, 0.95
    arrow(axes, (left + near, low), (left + near, high))
    arrow(axes, (left + far, high), (left + far, low))
    arrow(axes, (left + 2.2 + near, low), (left + 2.2 + far, high))
    arrow(axes, (left + 2.2 + near, high), (left + 2.2 + far, low))
    for port in (8.9, 9.7):
        for edge, inside in ((low, low + 0.25), (high, high - 0.25)):
            thin(axes, (port, edge), (port, inside))
            thin(axes, (port - 0.13, inside), (port + 0.13, inside))
    thin(axes, (left, high + 0.12), (left + 3.3, high + 0.12), width=0.9)
    thin(axes, (left, low - 0.12), (left + 3.3, low - 0.12), width=0.9)
    for end, outwards in ((left, -1.0), (left + 3.3, 1.0)):
        box(axes, min(end, end + 0.45 * outwards), low + 0.3, 0.45, 0.5)
        thin(axes, (end + 0.1 * outwards, low + 0.3), (end + 0.35 * outwards, low + 0.8))
