"""Branches of periodic orbits in s or d: pseudo-arclength, so that a fold is a point like others.

The tangent t of the branch is the null vector of the equations; the next point lies where t . (X - X_0) = step.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from controller.stability.actuator.model import Array
from controller.stability.orbits.arc import Loop
from controller.stability.orbits.floquet import is_one_sided, other_multipliers, peaks
from controller.stability.orbits.limit_cycle import (
    Orbit,
    correct,
    equations,
    hold,
    pack,
    unpack,
)

LEAST_STEP = 1e-7
STRAIGHT = 0.9  # least cosine between the tangents of neighbours


class Limits(NamedTuple):
    """How far a branch is followed."""

    least: float  # of the parameter
    most: float
    longest: float  # period
    step: float  # greatest, in scaled arclength
    points: int  # at most


class Branch(NamedTuple):
    """Orbits along a branch, and those where its parameter turns."""

    parameter: str  # "s" | "d"
    orbits: list[Orbit]
    folds: list[Orbit]

    @property
    def values(self) -> Array:
        """The parameter (n,)."""
        return np.array([getattr(orbit.loop.gains, self.parameter) for orbit in self.orbits])

    @property
    def periods(self) -> Array:
        return np.array([orbit.period for orbit in self.orbits])

    @property
    def peaks(self) -> Array:
        """Greatest y1 .. y4 of each orbit, (n, 4)."""
        return np.array([peaks(orbit) for orbit in self.orbits])

    @property
    def multipliers(self) -> Array:
        """Those beside the one along the orbit, the largest first, (n, 3)."""
        return np.array([other_multipliers(orbit) for orbit in self.orbits])

    @property
    def attracts(self) -> Array:
        return np.abs(self.multipliers).max(axis=1) < 1.0


def tangent(jacobian: Array, along: Array) -> Array:
    """Unit vector along the branch from the derivatives of its equations, turned like `along`."""
    null = np.linalg.svd(jacobian)[2][-1]
    return null if null @ along >= 0.0 else -null


def _advance(x: Array, t: Array, step: float, loop: Loop, parameter: str) -> tuple[Array, int, Array]:
    return correct(x + step * t, loop, parameter, lambda new: (float(t @ (new - x)) - step, t))


def follow_branch(orbit: Orbit, parameter: str, direction: float, limits: Limits) -> Branch:
    """The branch from an orbit on, first towards greater (direction 1.0) or smaller (-1.0) values of s or d.

    It ends behind the limits (the last orbit lies at `least` or `most` itself), before an orbit that switches more
    often than its equations know, or where Newton's method finds no neighbour. ValueError: it begins outside them.
    """
    value = getattr(orbit.loop.gains, parameter)
    if not (limits.least <= value <= limits.most and orbit.period <= limits.longest):
        raise ValueError(
            f"{parameter} {value}, period {orbit.period} of the first orbit must lie within {limits.least} .. "
            f"{limits.most} and {limits.longest}"
        )
    loop, x = orbit.loop, pack(orbit, parameter)
    t = tangent(equations(x, loop, parameter)[1], direction * np.eye(len(x))[-1])
    orbits, folds, step = [orbit], [], limits.step / 8.0
    while len(orbits) < limits.points and step > LEAST_STEP:
        try:
            new, turns, jacobian = _advance(x, t, step, loop, parameter)
            turned = tangent(jacobian, t)
        except (ArithmeticError, np.linalg.LinAlgError):
            step /= 2.0
            continue
        if t @ turned < STRAIGHT:
            step /= 2.0
            continue
        if t[-1] * turned[-1] < 0.0:
            folds.append(_fold(x, t, step, loop, parameter))
        if not limits.least <= new[-1] <= limits.most:
            new = _at(new, float(np.clip(new[-1], limits.least, limits.most)), loop, parameter)
            return Branch(parameter, [*orbits, unpack(new, loop, parameter)], folds)
        found = unpack(new, loop, parameter)
        if found.period > limits.longest or not is_one_sided(found):
            break
        orbits.append(found)
        x, t = new, turned
        step = min(step * (1.5 if turns <= 4 else 0.7), limits.step)
    return Branch(parameter, orbits, folds)


def _at(x: Array, value: float, loop: Loop, parameter: str) -> Array:
    start = np.append(x[:-1], value)
    return correct(start, loop, parameter, hold(start, -1))[0]


def _fold(x: Array, t: Array, step: float, loop: Loop, parameter: str) -> Orbit:
    """Where the tangent has no part along the parameter, between two points of the branch."""

    def slope(length: float) -> float:
        return tangent(_advance(x, t, length, loop, parameter)[2], t)[-1]

    length = float(brentq(slope, 0.0, step, xtol=1e-10))  # pyright: ignore[reportArgumentType]
    return unpack(_advance(x, t, length, loop, parameter)[0], loop, parameter)
