"""A straight line through data with errors in both coordinates: Wald's method of group means, (2.1)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike


class Line(NamedTuple):
    """y = slope x + intercept, and what the errors of x and y make of the slope."""

    slope: float
    intercept: float
    slope_deviation: float  # standard deviation of the slope, 0.0 for exact data


def fit_line(x: ArrayLike, y: ArrayLike, deviation_x: float = 0.0, deviation_y: float = 0.0) -> Line:
    """Fit a line through N points by Wald's group means, after (2.1).

    x, y: shape (N,), N >= 2, in any order and unit; deviations in the units of x and y.
    The points are sorted by x and split at N // 2. Raises ValueError when the halves share their mean x.
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    if x.shape != y.shape or x.ndim != 1 or len(x) < 2:
        raise ValueError(f"x and y must be one-dimensional, equally long and hold 2 points; got {x.shape}, {y.shape}")
    order = np.argsort(x, kind="stable")
    r = len(x) // 2
    low, high = order[:r], order[r:]
    spread = x[high].mean() - x[low].mean()
    if spread == 0.0:
        raise ValueError(f"all x are {x[0]}: a slope needs two different ones")
    slope = (y[high].mean() - y[low].mean()) / spread
    variance = (deviation_y**2 + slope**2 * deviation_x**2) * (1.0 / r + 1.0 / (len(x) - r)) / spread**2
    return Line(float(slope), float(y.mean() - slope * x.mean()), float(np.sqrt(variance)))
