"""Samples at instants of their own carried to an even grid. What is missing stays missing."""

import numpy as np
from numpy.typing import NDArray

from bridge.recording.logs.map import Method

Floats = NDArray[np.float64]
SAME = 1e-6  # of a period: an instant of a row and one of the grid that are one
USUAL = 3.0  # intervals that a hole may have where no limit is stated


def usual_interval(seconds: Floats) -> float:
    """The median interval between samples [s]."""
    steps = np.diff(seconds)
    return float(np.median(steps)) if len(steps) else 0.0


def resampled(grid: Floats, seconds: Floats, values: Floats, method: Method, gap: float) -> Floats:
    """Values at the instants of a grid [s]; NaN where none is known, and in holes longer than `gap` [s].

    A sample that is NaN is none. A hole is the time between the samples around an instant, whatever the method.
    """
    known = np.isfinite(values)
    seconds, values = seconds[known], values[known]
    if not len(seconds):
        return np.full(len(grid), np.nan)
    same = SAME * (grid[1] - grid[0]) if len(grid) > 1 else 0.0
    before = np.searchsorted(seconds, grid + same, side="right") - 1
    after = np.minimum(before + 1, len(seconds) - 1)
    left, right = np.maximum(before, 0), after
    met = (before >= 0) & (np.abs(grid - seconds[left]) <= same)
    hole = seconds[right] - seconds[left]
    inside = (before >= 0) & (before < len(seconds) - 1) & (hole <= gap * (1.0 + 1e-9))
    found = np.where(met | inside, _between(grid, seconds, values, left, right, method), np.nan)
    return np.where(met, values[left], found)


def _between(grid: Floats, seconds: Floats, values: Floats, left: NDArray, right: NDArray, method: Method) -> Floats:
    if method is Method.PREVIOUS:
        return values[left]
    width = np.where(right > left, seconds[right] - seconds[left], 1.0)
    share = (grid - seconds[left]) / width
    if method is Method.NEAREST:
        return np.where(share < 0.5, values[left], values[right])
    return values[left] + share * (values[right] - values[left])


def holes(grid: Floats, values: Floats) -> list[tuple[float, float]]:
    """First and last missing instant [s] of each hole on the grid."""
    missing = np.isnan(values).astype(np.int8)
    edges = np.flatnonzero(np.diff(missing, prepend=0, append=0))
    return [(float(grid[a]), float(grid[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]
