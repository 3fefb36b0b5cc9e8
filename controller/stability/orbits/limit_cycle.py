"""Periodic orbits of the analogue loop: a boundary value problem with one arc between two switching points.

Source: 5.3.3, Fig. 5.2. Every second arc is seen from the other side (`mirror`), so that all of them have h <= 0 and
the same valve edges. An orbit of m arcs, starts y_i and lengths T_i, obeys

    phi_(T_i)(y_i) = mirror(y_(i+1)),    h(y_i) = s y1 + d y2 = 0,    i = 0 .. m - 1,    y_m = y_0.

m = 1 is an orbit that is its own mirror image, over half its period; m = 2 any orbit with two switchings.
Near supply and return the root is laminar below `LAMINAR` of the whole drop, as in a real edge: where a pressure passes
supply or return its own slope would be infinite, and orbits move by no more than that share.
"""

from functools import partial
from typing import NamedTuple

import numpy as np

from controller.stability.actuator.model import (
    Actuator,
    Array,
    Feedback,
    mirror,
)
from controller.stability.orbits.arc import (
    Loop,
    derivatives,
    end_rates,
    follow,
)
from controller.stability.orbits.branch import Equations, fixed, newton

LAMINAR = 1e-9  # of the supply; see above
TOLERANCE = 1e-11  # of an arc's step
MIRROR = np.array([[-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]], float)
PARAMETERS = ("s", "d")


class Orbit(NamedTuple):
    """A periodic orbit."""

    loop: Loop
    starts: Array  # (m, 4), y_i
    lengths: Array  # (m,), T_i

    @property
    def laps(self) -> int:
        """Times the arcs are run through in a period: an odd number of mirrors closes after two."""
        return 2 if len(self.lengths) % 2 else 1

    @property
    def period(self) -> float:
        return float(self.lengths.sum()) * self.laps


def analogue_loop(kind: int, actuator: Actuator, gains: Feedback) -> Loop:
    """A loop of a kind of `arc`, with the root used here; it has no smoothing."""
    return Loop(kind, actuator, gains, 0.0, LAMINAR)


def with_gain(loop: Loop, parameter: str, value: float) -> Loop:
    """The loop with another s or d."""
    return loop._replace(gains=loop.gains._replace(**{parameter: value}))


def pack(orbit: Orbit, parameter: str) -> Array:
    """X (5 m + 1,): starts, lengths, parameter; x and x' scaled with alpha, as they are small with it."""
    values = [orbit.starts.ravel(), orbit.lengths, [getattr(orbit.loop.gains, parameter)]]
    return np.concatenate(values) / _scale(len(orbit.lengths), orbit.loop)


def unpack(x: Array, loop: Loop, parameter: str) -> Orbit:
    """The orbit of an X."""
    count = (len(x) - 1) // 5
    values = x * _scale(count, loop)
    return Orbit(
        with_gain(loop, parameter, float(values[-1])), values[: 4 * count].reshape(-1, 4), values[4 * count : -1]
    )


def _scale(count: int, loop: Loop) -> Array:
    alpha = loop.actuator.alpha
    return np.concatenate([np.tile([alpha, alpha, 1.0, 1.0], count), np.ones(count + 1)])


def equations(x: Array, loop: Loop, parameter: str) -> tuple[Array, Array]:
    """Residual (5 m,) and its derivatives (5 m, 5 m + 1). ArithmeticError where an arc cannot be followed."""
    orbit = unpack(x, loop, parameter)
    count, column, (s, d) = len(orbit.lengths), PARAMETERS.index(parameter), orbit.loop.gains
    residual, jacobian = np.zeros(5 * count), np.zeros((5 * count, 5 * count + 1))
    for i in range(count):
        row, rows, following = arc(orbit, i), slice(4 * i, 4 * i + 4), (i + 1) % count
        slopes = MIRROR @ derivatives(row)
        residual[rows] = mirror(row[:4]) - orbit.starts[following]
        jacobian[rows, 4 * i : 4 * i + 4] += slopes[:, :4]
        jacobian[rows, 4 * following : 4 * following + 4] -= np.eye(4)
        jacobian[rows, 4 * count + i] = MIRROR @ end_rates(row[:4], orbit.loop)
        jacobian[rows, -1] = slopes[:, 4 + column]
        residual[4 * count + i] = s * orbit.starts[i, 0] + d * orbit.starts[i, 1]
        jacobian[4 * count + i, [4 * i, 4 * i + 1, -1]] = s, d, orbit.starts[i, column]
    scale = _scale(count, orbit.loop)
    rows = np.concatenate([scale[: 4 * count], np.full(count, orbit.loop.actuator.alpha)])
    return residual / rows, jacobian * scale / rows[:, None]


def arc(orbit: Orbit, i: int) -> Array:
    if orbit.lengths[i] <= 0.0:
        raise ArithmeticError(f"length {orbit.lengths[i]} of an arc must be above 0")
    row, time = follow(orbit.starts[i], orbit.lengths[i], orbit.loop, TOLERANCE, False)
    if time < 0.0:
        raise ArithmeticError("the arc leaves the stroke")
    return row


def equations_of(loop: Loop, parameter: str) -> Equations:
    """`equations` as a branch is followed by them."""
    return partial(equations, loop=loop, parameter=parameter)


def solve(guess: Orbit, parameter: str = "d", place: int = -1) -> Orbit:
    """The orbit near a guess, with the unknown at this place of X unchanged: by default its s or d.

    ArithmeticError where Newton's method does not converge.
    """
    start = pack(guess, parameter)
    found = newton(start, equations_of(guess.loop, parameter), fixed(start, place))[0]
    return unpack(found, guess.loop, parameter)


def as_two_arcs(orbit: Orbit) -> Orbit:
    """An orbit that is its own mirror image, over its whole period: its neighbours need not be symmetric."""
    return Orbit(orbit.loop, np.repeat(orbit.starts, 2, axis=0), np.repeat(orbit.lengths, 2))
