"""Branches of periodic orbits in s or d, through folds, within limits."""

from itertools import islice
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from controller.stability.actuator.model import Array
from controller.stability.orbits.arc import Loop
from controller.stability.orbits.branch import Point, advance, branch, fixed, newton, tangent
from controller.stability.orbits.floquet import is_one_sided, other_multipliers, peaks
from controller.stability.orbits.limit_cycle import Orbit, equations_of, pack, unpack


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
    loop, x, of = orbit.loop, pack(orbit, parameter), equations_of(orbit.loop, parameter)
    line = branch(x, direction * np.eye(len(x))[-1], of, limits.step)
    orbits, folds, last = [orbit], [], next(line)
    for point in islice(line, limits.points - 1):
        if last.tangent[-1] * point.tangent[-1] < 0.0:
            folds.append(_fold(last, point.step, loop, parameter))
        if not limits.least <= point.z[-1] <= limits.most:
            end = _at(point.z, float(np.clip(point.z[-1], limits.least, limits.most)), loop, parameter)
            return Branch(parameter, [*orbits, unpack(end, loop, parameter)], folds)
        found = unpack(point.z, loop, parameter)
        if found.period > limits.longest or not is_one_sided(found):
            break
        orbits.append(found)
        last = point
    return Branch(parameter, orbits, folds)


def _at(x: Array, value: float, loop: Loop, parameter: str) -> Array:
    start = np.append(x[:-1], value)
    return newton(start, equations_of(loop, parameter), fixed(start, -1))[0]


def _fold(before: Point, step: float, loop: Loop, parameter: str) -> Orbit:
    """Where the tangent has no component along the parameter, within a step from a point of the branch."""
    x, t, of = before.z, before.tangent, equations_of(loop, parameter)

    def slope(length: float) -> float:
        return tangent(advance(x, t, length, of)[2], t)[-1]

    length = float(brentq(slope, 0.0, step, xtol=1e-10))  # pyright: ignore[reportArgumentType]
    return unpack(advance(x, t, length, of)[0], loop, parameter)
