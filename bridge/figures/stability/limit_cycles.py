"""Figures 5.4 and 5.5: periodic orbits of the relay loop over d and of the proportional loop over s.

Source: 5.3.3 and 5.4.2, alpha 0.01, k 0.5, gamma 0.5; relay with s 10, proportional valve with d 0.1. Added: the relay
with friction that falls with speed, whose branch folds; the multipliers; whence the unstable half of Fig. 5.5 comes.
"""

from typing import Any, NamedTuple

import numpy as np

from bridge.drawing.canvas import (
    Columns,
    Sheet,
    label,
    remark,
    tiles,
)
from controller.stability.actuator.analogue import analogue_edge
from controller.stability.actuator.model import Actuator
from controller.stability.actuator.relay import relay_edge
from controller.stability.orbits.arc import CROSSED
from controller.stability.orbits.birth import proportional_birth, relay_birth
from controller.stability.orbits.continuation import Branch, Limits, follow_branch

PLANT = Actuator(0.01, 0.5, 0.5)
FALLING = PLANT._replace(k=-0.2)  # assumed: the sign of the rig's seal, whose friction falls with speed
S, D = 10.0, 0.1
BLUE, RED, GREY, ORANGE = "#2a6fbb", "#c8413b", "#8a8f98", "#c77d1e"


class DrawnBranch(NamedTuple):
    """One branch in a picture."""

    name: str
    key: float  # tells it from the others in the table
    branch: Branch
    colour: str
    width: float


def relay_courses() -> list[DrawnBranch]:
    """From the edge down in d, to 0 or through the fold."""
    start, limits = 0.004, Limits(0.0, 0.4, 2.0, 0.03, 300)
    branches = [follow_branch(relay_birth(plant, S, start), "d", -1.0, limits) for plant in (PLANT, FALLING)]
    return [
        DrawnBranch("friction of the thesis, k 0.5", PLANT.k, branches[0], BLUE, 1.8),
        DrawnBranch("friction falling with speed,\nk -0.2", FALLING.k, branches[1], ORANGE, 1.3),
    ]


def proportional_courses() -> list[DrawnBranch]:
    """From the edge up in s; down only with crossed edges."""
    up = follow_branch(proportional_birth(PLANT, D, 1e-6), "s", 1.0, Limits(1.0, 2.0, 10.0, 0.03, 300))
    down = follow_branch(proportional_birth(PLANT, D, 1e-6, CROSSED), "s", -1.0, Limits(1.0, 2.0, 10.0, 0.03, 300))
    return [
        DrawnBranch("the loop", 0.0, up, BLUE, 1.8),
        DrawnBranch("no orbit of the loop: arcs with\nthe edges of the other sign of u", 1.0, down, GREY, 1.3),
    ]


def table(courses: list[DrawnBranch], parameter: str, key: str) -> Columns:
    """One row an orbit, the branches below each other, told apart by `key`; the multipliers beside 1 by their size."""
    keys = [np.full(len(course.branch.orbits), course.key) for course in courses]
    tops = np.vstack([course.branch.peaks for course in courses])
    multipliers = np.vstack([course.branch.multipliers for course in courses])
    columns: Columns = {
        key: np.concatenate(keys),
        f"{parameter} [-]": np.concatenate([course.branch.values for course in courses]),
        "half-period [-]": np.concatenate([course.branch.periods / 2.0 for course in courses]),
    }
    columns |= {f"greatest y{i + 1} [-]": tops[:, i] for i in range(4)}
    columns["stable [-]"] = (np.abs(multipliers).max(axis=1) < 1.0).astype(float)
    for i in range(3):
        columns[f"multiplier {i + 2} real [-]"] = multipliers[:, i].real
        columns[f"multiplier {i + 2} imaginary [-]"] = multipliers[:, i].imag
    return columns


def draw_relay() -> tuple[Columns, Sheet]:
    """Figure 5.4."""
    courses = relay_courses()
    columns = table(courses, "d", "k [-]")
    page, panels = tiles("Periodic orbits of the relay loop", 2, 3)
    edges = [float(relay_edge(S, plant.k, plant.gamma, plant.alpha)) for plant in (PLANT, FALLING)]
    _draw(panels, columns, courses, "d", "d_H", edges[0])
    fold = courses[1].branch.folds[0]
    panels[0].plot(fold.loop.gains.d, fold.period / 2.0, "o", color=ORANGE, markersize=5, label="fold")
    _legend(panels, "upper left")
    for axes in panels:
        axes.set_xlim(0.0, 0.4)
    limits = ((0.0, 1.0), (0.0, 6e-4), (0.0, 4e-3), (0.5, 1.03), (0.0, 1.3), (0.0, 1.3))
    for axes, bounds in zip(panels, limits, strict=True):
        axes.set_ylim(*bounds)
    remark(
        page,
        f"s {S:g}, alpha {PLANT.alpha:g}, gamma {PLANT.gamma:g}. Both branches begin with no amplitude and no period "
        f"at their d_H, {edges[0]:.4f} and {edges[1]:.4f}. Solid stable, dashed unstable.",
    )
    return columns, page


def draw_proportional() -> tuple[Columns, Sheet]:
    """Figure 5.5."""
    courses = proportional_courses()
    columns = table(courses, "s", "edges crossed [-]")
    page, panels = tiles("Periodic orbits of the proportional loop", 2, 3)
    _draw(panels, columns, courses, "s", "s_crit", float(analogue_edge(D, PLANT.k, PLANT.gamma)))
    _legend(panels, "upper right")
    for axes in panels:
        axes.set_xlim(1.0, 2.0)
    limits = ((2.16, 2.21), (0.0, 4e-3), (0.0, 10e-3), (0.5, 0.9), (0.5, 1.7), (0.5, 1.7))
    for axes, bounds in zip(panels, limits, strict=True):
        axes.set_ylim(*bounds)
    remark(
        page,
        f"d {D:g}, k {PLANT.k:g}, alpha {PLANT.alpha:g}, gamma {PLANT.gamma:g}. Solid stable, dashed unstable. "
        "Below s_crit runs of the loop come to rest; the unstable orbits of the thesis fit the grey curve.",
    )
    return columns, page


def _draw(
    panels: list[Any], columns: Columns, courses: list[DrawnBranch], parameter: str, edge: str, value: float
) -> None:
    names = "half-period", "greatest y1", "greatest y2", "greatest y3", "multiplier 2 real", "multiplier 3 real"
    words = "half-period T", "max y1, position", "max y2, velocity", "max y3, pressure", "multiplier", "next multiplier"
    for axes, name, word in zip(panels, names, words, strict=True):
        axes.axvline(value, color=RED, linestyle=":", linewidth=1.2, label=f"theory: {edge} {value:.4f}")
        for course in courses:
            _curve(axes, columns, parameter, f"{name} [-]", course)
        label(axes, parameter, word)
    panels[1].ticklabel_format(axis="y", style="sci", scilimits=(0, 0))
    panels[2].ticklabel_format(axis="y", style="sci", scilimits=(0, 0))
    panels[4].axhline(1.0, color="0.4", linewidth=0.8)


def _legend(panels: list[Any], place: str) -> None:
    """In the last panel, which has the room; over the line of the edge."""
    panels[-1].legend(*panels[0].get_legend_handles_labels(), loc=place, fontsize=8, framealpha=1.0, edgecolor="none")


def _curve(axes: Any, columns: Columns, parameter: str, name: str, course: DrawnBranch) -> None:
    """Solid where stable, dashed where not; both parts meet."""
    mine = next(iter(columns.values())) == course.key
    across, up, stable = columns[f"{parameter} [-]"][mine], columns[name][mine], columns["stable [-]"][mine] > 0.5
    style: dict[str, Any] = {"color": course.colour, "linewidth": course.width}
    if stable.any():
        axes.plot(across[stable], up[stable], "-", label=course.name, **style)
    if not stable.all():
        first = max(int(np.argmin(stable)) - 1, 0)
        axes.plot(across[first:], up[first:], "--", label=None if stable.any() else course.name, **style)
