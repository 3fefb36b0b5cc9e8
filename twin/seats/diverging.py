"""Flow between two plates that diverge: the boundary value problem (3.46), (3.47) of the thesis for the wall shear.

`F''' = G - R F F''` with `F'(0) = 1, F'(1) = 0, F(0) = F0, F(1) = 0`: four conditions for a third-order equation and
its unknown pressure gradient G = g Re. R = Re/xi = V H/(nu r/H), u = V F' along the gap, -V F/xi across it. A cone that
opens at v has V = v cos a at its wall, and F0 = +xi tan a (the wall goes away from the housing; the thesis's sign, and
its value without xi, are slips). F0 = 0 is the wall that slides only. Chebyshev collocation and Newton.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]
POINTS = 24  # of the polynomial: 1e-11 up to R of some 10


class Channel(NamedTuple):
    """A solution, at the points eta from the moving wall, 0, to the one at rest, 1."""

    eta: Array
    stream: Array  # F
    speed: Array  # F' = u/V
    gradient: float  # G = g Re
    shear: float  # F''(0), at the moving wall
    shear_at_rest: float  # F''(1)


def chebyshev(points: int) -> tuple[Array, Array]:
    """Points on 0 .. 1 and the matrix that differentiates there, (n), (n, n)."""
    j = np.arange(points)
    x = 0.5 * (1.0 - np.cos(np.pi * j / (points - 1)))
    c = np.where((j == 0) | (j == points - 1), 2.0, 1.0) * (-1.0) ** j
    gaps = x[:, None] - x[None, :] + np.eye(points)
    matrix = np.outer(c, 1.0 / c) / gaps
    return x, matrix - np.diag(matrix.sum(axis=1))


def creeping(eta: Array, normal: float) -> Array:
    """F' without inertia, R = 0, F0 = normal: 1 - (4 + 6 F0) eta + (3 + 6 F0) eta^2; then G = 6 + 12 F0."""
    return 1.0 - (4.0 + 6.0 * normal) * eta + (3.0 + 6.0 * normal) * eta**2


def solve(reynolds: float, normal: float = 0.0) -> Channel:
    """The flow at R = Re/xi and F0 = normal. Raises ValueError where Newton's method finds none.

    An outflow fast enough for the equation to have several solutions or none is beyond a valve's gap (R below 1).
    """
    eta, d = chebyshev(POINTS)
    d2, d3, n = d @ d, d @ d @ d, POINTS
    stream = np.concatenate([[normal], normal + np.cumsum(_means(creeping(eta, normal), eta))])
    unknown = np.append(stream, 6.0 + 12.0 * normal)
    for _ in range(30):
        F, G = unknown[:n], unknown[n]
        residual = np.concatenate([(d3 @ F - G + reynolds * F * (d2 @ F))[2:-1], _ends(F, d, normal)])
        slope = np.zeros((n + 1, n + 1))
        inner = d3 + reynolds * (F[:, None] * d2 + np.diag(d2 @ F))
        slope[: n - 3, :n], slope[: n - 3, n] = inner[2:-1], -1.0
        slope[n - 3, 0] = slope[n - 2, n - 1] = 1.0
        slope[n - 1, :n], slope[n, :n] = d[0], d[-1]
        change = np.linalg.solve(slope, -residual)
        unknown = unknown + change
        if np.abs(change).max() <= 1e-11 * np.abs(unknown).max():
            F = unknown[:n]
            return Channel(eta, F, d @ F, float(unknown[n]), float(d2[0] @ F), float(d2[-1] @ F))
    raise ValueError(f"no flow found at R = {reynolds}, F0 = {normal}; take a smaller R, a valve's gap has below 1")


def _means(values: Array, eta: Array) -> Array:
    return 0.5 * (values[1:] + values[:-1]) * np.diff(eta)


def _ends(F: Array, d: Array, normal: float) -> Array:
    return np.array([F[0] - normal, F[-1], d[0] @ F - 1.0, d[-1] @ F])
