"""A branch of solutions of F(x, p) = 0 by pseudo-arclength, so that a fold is a point like others.

z = (x, p). The next point lies on the plane a step ahead, t . (z - z_0) = step, with t the unit null vector of the
derivatives of F; Newton's method takes it there. Nothing here knows what is continued.
"""

from collections.abc import Callable, Iterator

import numpy as np

from controller.stability.plant import Array

Equations = Callable[[Array], tuple[Array, Array]]  # z (n + 1,) -> F (n,), its derivatives (n, n + 1); ArithmeticError
TURNS, SMALL = 12, 1e-9  # Newton steps; what is left of F and of the step ahead
LEAST = 1e-8  # step, below which the branch is given up
STRAIGHT = 0.9  # cosine between neighbouring tangents


def corrected(z: Array, t: Array, equations: Equations) -> Array:
    """The solution on the plane through z across t. Raises ArithmeticError where Newton finds none."""
    start, worst = z, np.inf
    for _ in range(TURNS):
        residual, slopes = equations(z)
        left = np.append(residual, t @ (z - start))
        worst = np.abs(left).max()
        if worst < SMALL:
            return z
        try:
            z = z - np.linalg.solve(np.vstack([slopes, t]), left)
        except np.linalg.LinAlgError:
            break
    raise ArithmeticError(f"Newton's method leaves {worst:.1e} after {TURNS} steps")


def tangent(z: Array, along: Array, equations: Equations) -> Array:
    """Unit vector along the branch at one of its points, on the side of `along`."""
    null = np.linalg.svd(equations(z)[1])[2][-1]
    return null if null @ along >= 0.0 else -null


def branch(z: Array, along: Array, equations: Equations, longest: float) -> Iterator[Array]:
    """Solutions from z (near one) on, towards `along`, at most `longest` apart; ends where none is found."""
    z = corrected(z, along / np.linalg.norm(along), equations)
    t, step = tangent(z, along, equations), longest / 8.0
    yield z
    while step > LEAST:
        try:
            new = corrected(z + step * t, t, equations)
            turned = tangent(new, t, equations)
        except ArithmeticError:
            step /= 2.0
            continue
        if turned @ t < STRAIGHT:
            step /= 2.0
            continue
        z, t, step = new, turned, min(1.5 * step, longest)
        yield z
