"""A chart of flow and damping by runs with impacts: calm, swinging, hitting. A row is a task of its own, pure."""

from functools import partial
from pathlib import Path

import numpy as np

from bridge.drawing.canvas import (
    Axes,
    Columns,
    Sheet,
    label,
    remark,
    sheet,
)
from bridge.studies.sweep.engine import Crew, sweep
from bridge.studies.sweep.journal import Point, Result
from twin.chatter.basin import chart
from twin.chatter.equilibrium import onset
from twin.chatter.system import System


def row(point: Point, s: System, flows: tuple[float, ...]) -> Result:
    """Verdicts and last tops at one damping, from a push of 1 %."""
    kind, top = chart(s, np.array(flows), np.array([point["damping"]]), shut=False)
    return {"kind": kind[0].tolist(), "top": top[0].tolist()}


def rows(s: System, flows: np.ndarray, dampings: np.ndarray, part: Path, crew: Crew) -> tuple[np.ndarray, np.ndarray]:
    """All rows, (dampings, flows) each; `part` keeps those found until all are, and an interrupted chart continues."""
    places = tuple(float(q) for q in flows)
    about = {"title": "chart of a valve", "system": [str(value) for value in s], "flows": places}
    points = [{"damping": float(k)} for k in dampings]
    found = sweep(partial(row, s=s, flows=places), points, about, part, crew)
    return np.array([one["kind"] for one in found]), np.array([one["top"] for one in found])


def draw(
    name: str, s: System, flows: np.ndarray, dampings: np.ndarray, part: Path, crew: Crew
) -> tuple[Columns, Sheet]:
    """The chart with k_crit by linear theory."""
    kind, top = rows(s, flows, dampings, part, crew)
    page, (axes,) = sheet(f"{name} seat, e = {s.precompression:.3g}, β = {s.beta:.5f}: what a push of 1 % ends in")
    patches(axes, flows, dampings, kind)
    patches_legend(axes)
    critical = [onset(s._replace(flow=float(q))).damping for q in flows]
    axes.plot(flows, critical, color="black", linewidth=1.0)
    axes.set_ylim(float(dampings[0]), float(dampings[-1]))
    label(axes, "q [-]", "k [-]")
    remark(page, f"{len(flows)} x {len(dampings)} runs with impacts; line: k_crit by linear theory")
    q, k = np.meshgrid(flows, dampings)
    return {
        "q [-]": q.ravel(), "k [-]": k.ravel(), "kind [0 calm; 1 swings; 2 hits]": kind.ravel(), "top [-]": top.ravel(),
    }, page  # fmt: skip


SHADES = ("#f4f4f4", "#f6c36b", "#b5443c")  # calm, swings, hits


WORDS = ("calm", "swings freely", "hits its seat")


def patches(axes: Axes, x: np.ndarray, y: np.ndarray, kind: np.ndarray) -> None:
    """Verdicts as coloured cells."""
    from matplotlib.colors import ListedColormap

    axes.pcolormesh(x, y, kind, cmap=ListedColormap(SHADES), vmin=-0.5, vmax=2.5, shading="nearest")


def patches_legend(axes: Axes) -> None:
    """What the colours mean."""
    for shade, words in zip(SHADES, WORDS, strict=True):
        axes.plot([], [], "s", color=shade, markeredgecolor="0.5", label=words)
    axes.legend(frameon=True, fontsize=8, loc="upper right")
