"""Figures 2.25 and 2.26: the method of lines with every space and time, on a smooth wave and on steep fronts.

Source: 2.5.4; f1 = sin(2 pi (x - a t)/L); f2 has fronts tanh(10 (x - a t)), here a periodic train of them, since one
front alone has left after one travel time. Ten periods run through a line of L = 1 m, driven by the exact values at
both ends, steps of a wave through a cell. Work is counted, not timed, so that it is the same at every run: unknowns
that were solved for. The thesis held the ends' values over each step; what that costs is drawn dashed.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bridge.drawing.canvas import (
    Array,
    Columns,
    Sheet,
    label,
    lattice,
    remark,
)
from twin.lines.lab.friction import friction
from twin.lines.lab.integrate import TIMES, until
from twin.lines.lab.pipe import PRESSURE, VELOCITY, Case, End, Pipe
from twin.lines.lab.propagate import propagate, propagator
from twin.lines.lab.space import SPACES, grid
from twin.lines.lab.system import State, line_system
from twin.lines.lab.tableau import PAIRS

PIPE = Pipe(1.0, 0.02, 1.0, 1.0, 1e-6)  # L = a = rho a = 1
PERIODS = 10.0
CELLS = (10, 20, 40, 80)
HELD = "esdirk4 with ends held over the step"
STYLE = {
    "backward-euler": ("o-", "black"), "bdf2": ("*-", "purple"), "esdirk3": ("+-", "tab:blue"),
    "esdirk4": ("x-", "tab:red"), "esdirk5": ("s-", "tab:green"), HELD: (".--", "0.5"),
}  # fmt: skip
NAMES = {"cds3": "CDS3", "cds5": "CDS5, summation by parts", "fem": "FEM", "chebyshev": "Chebyshev"}


class Point(NamedTuple):
    """One run."""

    error: float  # L2, over that of the wave
    solved: float  # unknowns


def smooth(s: float) -> float:
    """f1 over x - a t."""
    return math.sin(2.0 * math.pi * s)


def steep(s: float) -> float:
    """Fronts of f2, one up and one down in each period, from -1/2 to 1/2; those two periods away are flat to 1e-11."""
    inside = s - math.floor(s)
    train = sum(math.tanh(10.0 * (inside - 0.25 - m)) - math.tanh(10.0 * (inside - 0.75 - m)) for m in (-1, 0, 1))
    return 0.5 * train - 0.5


def run(wave: Callable[[float], float], space: str, method: str, cells: int, periods: float = PERIODS) -> Point:
    """Error and work of one scheme; method: a time scheme, or HELD."""
    time = "esdirk4" if method == HELD else method
    ends = (
        End(VELOCITY, lambda t: wave(-t)),
        End(PRESSURE, lambda t: wave(1.0 - t)),
    )
    places = grid(space, cells, 1.0)
    system, start = line_system(Case(PIPE, *ends, 0.0, 0.0), places, friction("none"))
    first, step = State(_both(wave, places.x), start.w), 1.0 / cells
    if time == "bdf2":
        found = until(system, first, time, step, periods).y
    else:
        one = propagator(system, time, step)
        found = propagate(system, one, first, round(periods / step), method == HELD).y
    right = _both(wave, places.x - periods)
    weights = np.tile(places.norm.sum(axis=1), 2)
    error = np.sqrt(weights @ (found - right) ** 2 / (weights @ right**2))
    solves = len(PAIRS[time].c) - 1 if time in PAIRS else 1
    return Point(float(error), 2.0 * (cells + 1) * solves * cells * periods)


def _both(wave: Callable[[float], float], s: Array) -> Array:
    """p and u of a wave that runs through."""
    return np.tile([wave(float(value)) for value in s], 2)


def columns(wave: Callable[[float], float], cells: tuple[int, ...] = CELLS, periods: float = PERIODS) -> Columns:
    """A row per space and number of cells."""
    rows = [(space, n) for space in SPACES for n in cells]
    table: Columns = {
        f"space [{'; '.join(f'{i} {name}' for i, name in enumerate(SPACES))}]": np.array(
            [SPACES.index(space) for space, _ in rows], float
        ),
        "cells [-]": np.array([n for _, n in rows], float),
    }
    for method in (*TIMES, HELD):
        points = [run(wave, space, method, n, periods) for space, n in rows]
        table[f"error {method} [-]"] = np.array([point.error for point in points])
        table[f"solved {method} [unknowns]"] = np.array([point.solved for point in points])
    return table


def draw_smooth() -> tuple[Columns, Sheet]:
    """Figure 2.25."""
    return _draw("2.25  A smooth wave, ten periods, driven ends", smooth)


def draw_steep() -> tuple[Columns, Sheet]:
    """Figure 2.26."""
    return _draw("2.26  Steep fronts, ten periods, driven ends", steep)


def _draw(title: str, wave: Callable[[float], float]) -> tuple[Columns, Sheet]:
    table = columns(wave)
    page, (upper, lower) = lattice(title, 2, len(SPACES))
    for i, space in enumerate(SPACES):
        mine = next(iter(table.values())) == i
        for method, (mark, colour) in STYLE.items():
            error = table[f"error {method} [-]"][mine]
            for axes, across in ((upper[i], "cells [-]"), (lower[i], f"solved {method} [unknowns]")):
                axes.loglog(table[across][mine], error, mark, color=colour, linewidth=0.9, markersize=5, label=method)
        upper[i].set_title(NAMES[space], fontsize=9)
        upper[i].set_xticks(CELLS, [str(n) for n in CELLS])
        upper[i].minorticks_off()
        label(upper[i], "cells N", "")
        label(lower[i], "unknowns solved for", "")
    for row in (upper, lower):
        row[0].set_ylabel("relative $L_2$ error")
    handles, names = upper[0].get_legend_handles_labels()
    page.legend(handles, names, loc="outside lower center", ncols=len(STYLE), frameon=False, fontsize=8)
    remark(page, "steps of Δx/a")
    return table, page
