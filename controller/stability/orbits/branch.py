"""A branch of solutions of F(x, p) = 0 by pseudo-arclength, so that a fold is a point like others.

z = (x, p). The next point lies on the plane a step ahead, t . (z - z_0) = step, with t the unit null vector of the
derivatives of F; Newton's method takes it there. Nothing here knows what is continued.
"""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # of floats
Equations = Callable[[Array], tuple[Array, Array]]  # z (n + 1,) -> F (n,), its derivatives (n, n + 1); ArithmeticError
Condition = Callable[[Array], tuple[float, Array]]  # z -> a further equation, its gradient (n + 1,)
TURNS, SMALL = 12, 1e-9  # Newton steps; change of a scaled unknown after which they end
QUICK = 4  # Newton steps of a point after which the next may be further away
FARTHEST = 1.0  # change of a scaled unknown beyond which Newton's method has lost the solution
LEAST = 1e-7  # step, below which the branch is given up
STRAIGHT = 0.9  # least cosine between the tangents of neighbours


class Point(NamedTuple):
    """A solution on a branch."""

    z: Array
    tangent: Array  # unit vector, onwards
    step: float  # from the point before it; 0.0 for the first


def newton(z: Array, equations: Equations, condition: Condition) -> tuple[Array, int, Array]:
    """The solution near z, the steps taken, and the derivatives of the equations there, but for a change below SMALL.

    Raises ArithmeticError where Newton's method finds none.
    """
    for turn in range(TURNS):
        residual, slopes = equations(z)
        value, gradient = condition(z)
        try:
            change = np.linalg.solve(np.vstack([slopes, gradient]), np.append(residual, value))
        except np.linalg.LinAlgError:
            break
        z = z - change
        if np.abs(change).max() < SMALL:
            return z, turn + 1, slopes
        if not np.abs(change).max() < FARTHEST:
            break
    raise ArithmeticError("Newton's method does not converge")


def fixed(z: Array, place: int) -> Condition:
    """The condition that one unknown keeps its value."""
    value, gradient = z[place], np.eye(len(z))[place]
    return lambda new: (new[place] - value, gradient)


def advance(z: Array, t: Array, step: float, equations: Equations) -> tuple[Array, int, Array]:
    """The solution on the plane across t, a step ahead of z; as `newton`."""
    return newton(z + step * t, equations, lambda new: (float(t @ (new - z)) - step, t))


def tangent(slopes: Array, along: Array) -> Array:
    """Unit vector along the branch from the derivatives of its equations, on the side of `along`."""
    try:
        null = np.linalg.svd(slopes)[2][-1]
    except np.linalg.LinAlgError as error:
        raise ArithmeticError(str(error)) from None
    return null if null @ along >= 0.0 else -null


def branch(z: Array, along: Array, equations: Equations, longest: float) -> Iterator[Point]:
    """Points from a solution z on, itself the first, towards `along`, at most `longest` apart; ends where none is
    found."""
    t, step = tangent(equations(z)[1], along), longest / 8.0
    yield Point(z, t, 0.0)
    while step > LEAST:
        try:
            new, turns, slopes = advance(z, t, step, equations)
            turned = tangent(slopes, t)
        except ArithmeticError:
            step /= 2.0
            continue
        if t @ turned < STRAIGHT:
            step /= 2.0
            continue
        yield Point(new, turned, step)
        z, t, step = new, turned, min(step * (1.5 if turns <= QUICK else 0.7), longest)
