"""Branches of periodic orbits in s or d: pseudo-arclength, so that a fold is a point like others.

The tangent t of the branch is the null vector of the equations; the next point lies where t . (X - X_0) = step.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from controller.stability.actuator import Array, Feedback
from controller.stability.arc import PROPORTIONAL, Loop
from controller.stability.limit_cycle import Orbit, correct, equations, pack, peaks, stable, unpack

LEAST_STEP = 1e-7


class Range(NamedTuple):
    """How far a branch is followed."""

    least: float  # of the parameter
    most: float
    shortest: float  # half-period
    step: float  # greatest, in scaled arclength
    points: int  # at most


class Branch(NamedTuple):
    """Orbits along a branch, and where its parameter turns."""

    parameter: str
    orbits: list[Orbit]
    folds: list[Orbit]

    @property
    def values(self) -> Array:
        return np.array([getattr(orbit.loop.gains, self.parameter) for orbit in self.orbits])

    @property
    def half_periods(self) -> Array:
        return np.array([orbit.half_period for orbit in self.orbits])

    @property
    def peaks(self) -> Array:
        """Greatest y1 .. y4 of each orbit, (n, 4)."""
        return np.array([peaks(orbit) for orbit in self.orbits])

    @property
    def stable(self) -> Array:
        return np.array([stable(orbit) for orbit in self.orbits])


def tangent(x: Array, loop: Loop, parameter: str, along: Array) -> Array:
    """Unit vector along the branch, turned like `along`."""
    null = np.linalg.svd(equations(x, loop, parameter)[1])[2][-1]
    return null if null @ along >= 0.0 else -null


def _advance(x: Array, t: Array, step: float, loop: Loop, parameter: str) -> tuple[Array, int]:
    return correct(x + step * t, loop, parameter, lambda new: (t @ (new - x) - step, t))


def follow_branch(orbit: Orbit, parameter: str, direction: float, limits: Range) -> Branch:
    """The branch from an orbit on, first towards greater (direction 1.0) or smaller (-1.0) values of s or d."""
    loop, x = orbit.loop, pack(orbit, parameter)
    t = tangent(x, loop, parameter, direction * np.eye(len(x))[-1])
    orbits, folds, step = [orbit], [], limits.step / 8.0
    while len(orbits) < limits.points and step > LEAST_STEP:
        try:
            new, turns = _advance(x, t, step, loop, parameter)
            turned = tangent(new, loop, parameter, t)
        except (ArithmeticError, np.linalg.LinAlgError):
            step /= 2.0
            continue
        if t @ turned < 0.9:
            step /= 2.0
            continue
        if t[-1] * turned[-1] < 0.0:
            folds.append(_fold(x, t, step, loop, parameter))
        orbits.append(unpack(new, loop, parameter))
        if not (limits.least <= new[-1] <= limits.most and new[-2] >= limits.shortest):
            break
        x, t = new, turned
        step = min(step * (1.5 if turns <= 4 else 0.7), limits.step)
    return Branch(parameter, orbits, folds)


def _fold(x: Array, t: Array, step: float, loop: Loop, parameter: str) -> Orbit:
    """Where the tangent has no part along the parameter, between two points of the branch."""

    def slope(length: float) -> float:
        return tangent(_advance(x, t, length, loop, parameter)[0], loop, parameter, t)[-1]

    length = float(brentq(slope, 0.0, step, xtol=1e-10))  # pyright: ignore[reportArgumentType]
    return unpack(_advance(x, t, length, loop, parameter)[0], loop, parameter)


def born(loop: Loop, amplitude: float) -> Orbit:
    """The small orbit of a proportional loop near its critical s, with y2 = -amplitude at the switch.

    At the edge lam^3 + k lam^2 + (2 + sqrt2 gamma d) lam + sqrt2 gamma s has the roots +-i omega. ArithmeticError
    where the amplitude is too great for the linear orbit to be a guess.
    """
    if loop.kind != PROPORTIONAL or loop.actuator.k <= 0.0:
        raise ValueError(f"an orbit is born so only in a proportional loop with k > 0, not with k {loop.actuator.k}")
    (alpha, gamma, k), d = loop.actuator, loop.gains.d
    edge, omega = k * (d + math.sqrt(2.0) / gamma), math.sqrt(2.0 + math.sqrt(2.0) * gamma * d)
    y1, y2 = amplitude * d / edge, -amplitude
    difference = (k * y2 - omega**2 * y1) / alpha  # y2' = -omega^2 y1 on the linear orbit
    node = np.array([y1, y2, 0.5 + 0.5 * difference, 0.5 - 0.5 * difference])
    start = pack(Orbit(loop._replace(gains=Feedback(edge, d)), node[None, :], math.pi / omega), "s")
    pick = np.eye(len(start))[1]
    x, _ = correct(start, loop, "s", lambda x: (x[1] - start[1], pick))
    return unpack(x, loop, "s")


