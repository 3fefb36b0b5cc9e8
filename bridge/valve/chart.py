"""A chart of flow and damping by runs with impacts: calm, swinging, hitting. A row is a task of its own, pure."""

import multiprocessing
import os
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import numpy as np

from bridge.figures.canvas import Columns, Sheet, label, remark, sheet
from bridge.figures.valve_impact import patches, patches_legend
from twin.chatter.basin import chart
from twin.chatter.equilibrium import onset
from twin.chatter.system import System


def row(s: System, flows: tuple[float, ...], damping: float) -> tuple[list[float], list[float]]:
    """Verdicts and last tops at one damping, from a push of 1 %."""
    kind, top = chart(s, np.array(flows), np.array([damping]), shut=False)
    return kind[0].tolist(), top[0].tolist()


def rows(s: System, flows: np.ndarray, dampings: np.ndarray, workers: int) -> tuple[np.ndarray, np.ndarray]:
    """All rows, (dampings, flows) each; workers: processes, 0 for one a core."""
    task = partial(row, s, tuple(float(q) for q in flows))
    found = list(_mapped(task, [float(k) for k in dampings], workers or os.cpu_count() or 1))
    return np.array([kind for kind, _ in found]), np.array([top for _, top in found])


def _mapped(task, points: Iterable[float], workers: int) -> Iterator[tuple[list[float], list[float]]]:
    if workers == 1:
        yield from map(task, points)
        return
    with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
        yield from pool.map(task, points, chunksize=4)


def draw(name: str, s: System, flows: np.ndarray, dampings: np.ndarray, workers: int) -> tuple[Columns, Sheet]:
    """The chart with k_crit by linear theory."""
    kind, top = rows(s, flows, dampings, workers)
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
