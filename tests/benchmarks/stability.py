"""Charts of stability: counted by Schur's recursion, beside numpy's eigenvalues; areas of the thesis's charts."""

import math
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bridge.figures.stability.charts import CHARTS, shares
from controller.stability import Timing, monodromy
from controller.stability.chart import stable_multipliers
from tests.benchmarks.plant import Row

SIDE = 1000  # cells
LOOPED = 20  # columns of the plain loop, whose time is scaled to all of them; their matrices are made before
K, GAMMA, DELAY = 0.1, 0.23, 0.7
TAU, S = np.linspace(0.02, 20.0, SIDE), np.linspace(0.005, 5.0, SIDE)


def chart() -> np.ndarray:
    """The whole chart, from the matrices on."""
    return stable_multipliers(S[:, None], 0.0, K, GAMMA, Timing(TAU, DELAY))


def matrices(columns: np.ndarray) -> np.ndarray:
    """The matrices of whole columns of the chart, (s, column, n, n)."""
    return monodromy(S[:, None], 0.0, K, GAMMA, Timing(TAU[columns], DELAY))


def inside(mu: np.ndarray) -> np.ndarray:
    """How many multipliers are stable."""
    return (np.abs(mu) < 1.0 - 1e-12).sum(axis=-1)


def rows(folder: Path) -> Iterator[Row]:
    """Speed, then the share of each of the thesis's charts that has 3, 2, 1, 0 stable multipliers."""
    counted, took = chart(), math.inf
    for _ in range(5):
        start = time.perf_counter()
        counted = chart()
        took = min(took, time.perf_counter() - start)
    columns = np.arange(0, SIDE, SIDE // LOOPED)
    made = matrices(columns)
    start = time.perf_counter()
    found = np.array([[inside(np.linalg.eigvals(matrix)) for matrix in row] for row in made])
    middle = time.perf_counter()
    stacked = inside(np.linalg.eigvals(made))
    end = time.perf_counter()
    if not np.array_equal(found, counted[:, columns]) or not np.array_equal(stacked, found):
        raise AssertionError("the chart, the plain loop and the stack differ")
    loop, stack = ((middle - start) * SIDE / LOOPED, (end - middle) * SIDE / LOOPED)
    name = f"stability chart, {SIDE} x {SIDE}, delay {DELAY} tau"
    yield name, f"{took:.3f} s", f"eigvals, cell by cell: {loop:.1f} s", f"{loop / took:.0f}"
    yield name, f"{took:.3f} s", f"eigvals, all at once: {stack:.1f} s", f"{stack / took:.0f}"
    for number, of in CHARTS.items():
        areas = " ".join(f"{n}: {share:.4f}" for n, share in reversed(list(enumerate(shares(of)))))
        yield f"figure {number}: area by stable", areas, f"k {of.k:g}, d {of.d:g}", ""
