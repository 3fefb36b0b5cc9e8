"""Charts of stability: counted by Schur's recursion, beside numpy's eigenvalues; and the areas of the source's charts."""

import math
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bridge.figures.stability_charts import CHARTS, shares
from controller.stability import monodromy
from controller.stability.chart import stable_multipliers
from tests.benchmarks.plant import Row

SIDE = 1000  # cells
LOOPED = 20_000  # cells of the plain loop, whose time is scaled to all of them
K, GAMMA, DELAY = 0.1, 0.23, 0.7
TAU, S = np.linspace(0.02, 20.0, SIDE), np.linspace(0.005, 5.0, SIDE)


def chart() -> np.ndarray:
    """The whole chart, from the matrices on."""
    return stable_multipliers(S[:, None], 0.0, K, GAMMA, TAU, DELAY)


def plain(cells: np.ndarray) -> np.ndarray:
    """Chosen cells: a matrix and its eigenvalues each, nothing shared but what an interval's cells have in common."""
    by_interval = {}
    found = np.empty(len(cells), np.int8)
    for i, (row, column) in enumerate(cells.tolist()):
        if column not in by_interval:
            at_none, at_one = (monodromy(s, 0.0, K, GAMMA, TAU[column], DELAY) for s in (0.0, 1.0))
            by_interval[column] = at_none, at_one - at_none
        base, slope = by_interval[column]
        found[i] = (np.abs(np.linalg.eigvals(base + S[row] * slope)) < 1.0 - 1e-12).sum()
    return found


def rows(folder: Path) -> Iterator[Row]:
    """Speed, then the share of each of the source's charts that has 3, 2, 1, 0 stable multipliers."""
    counted, took = chart(), math.inf
    for _ in range(5):
        start = time.perf_counter()
        counted = chart()
        took = min(took, time.perf_counter() - start)
    columns = np.random.default_rng(0).choice(SIDE, 20, replace=False)
    cells = np.array([(row, column) for column in columns for row in range(SIDE)])[:LOOPED]
    start = time.perf_counter()
    found = plain(cells)
    loop = (time.perf_counter() - start) * SIDE**2 / len(cells)
    if not np.array_equal(found, counted[tuple(cells.T)]):
        raise AssertionError("the chart and the plain loop differ")
    start = time.perf_counter()
    inside = np.abs(np.linalg.eigvals(monodromy(S[cells[:, 0]], 0.0, K, GAMMA, TAU[cells[:, 1]], DELAY))) < 1.0 - 1e-12
    stacked = (time.perf_counter() - start) * SIDE**2 / len(cells)
    if not np.array_equal(inside.sum(axis=-1), found):
        raise AssertionError("the stack and the plain loop differ")
    words = f"numpy eigvals, cell by cell: {loop:.1f} s"
    yield f"stability chart, {SIDE} x {SIDE}, delay {DELAY} tau", f"{took:.3f} s", words, f"{loop / took:.0f}"
    yield "", "", f"matrices and eigvals, all in one stack: {stacked:.1f} s", f"{stacked / took:.0f}"
    for number, of in CHARTS.items():
        areas = " ".join(f"{n}: {share:.4f}" for n, share in reversed(list(enumerate(shares(of)))))
        yield f"area of figure {number} by stable multipliers", areas, f"k {of.k:g}, d {of.d:g}", ""
