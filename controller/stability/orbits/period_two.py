"""Orbits of period two of the sampled loop about the whole actuator: born where a multiplier passes -1, then followed.

An orbit repeats after two samples, x = P(P(x)), P of `stroboscope`; near its birth the command only changes sign, |u|
being the same all the time. There the square-root valve does, to first order in the swing, what a damping of the
pressure difference a = alpha (y3 - y4) does: u > 0 gives a' = -2 z2 + sqrt2 gamma u (1 - a/(2 alpha)), u < 0 the mirror
image, so

    a' = -2 z2 - g a + sqrt2 gamma u,   g = gamma |u|/(sqrt2 alpha).

So the orbit of opening |u| stands at the flip of that linear loop: the law of the amplitude is linear, not quadratic,
and its slope says whether the flip is soft (stable orbits beside the unstable rest) or hard.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from controller.stability.actuator.constant_command import SimulatedActuator
from controller.stability.actuator.simulate import Sampled
from controller.stability.crossing import Spectrum
from controller.stability.curves import flip_gain
from controller.stability.orbits.branch import Equations, advance, branch
from controller.stability.orbits.stroboscope import (
    command,
    period,
    scale_of,
    width_of,
)
from controller.stability.plant import SQRT2, Array, Plant, linear_actuator
from controller.stability.sampled import SampledLoop, closed, sampled_loop
from controller.stability.timing import Timing

FIRST = 1e-2  # size of the first orbit: swing of the pressures, in units of the supply pressure
LONGEST = 0.1  # between neighbours of a branch, in these units


class Orbit(NamedTuple):
    """An orbit of period two."""

    s: float
    points: Array  # (2, n) at the samples, laid out as in `stroboscope`
    opening: float  # |u| given at the first of them
    multipliers: Spectrum  # (n,), of two periods

    @property
    def stable(self) -> bool:
        """Do all neighbours come to it? The common level of the pressures included: it, too, goes to the middle."""
        return bool(np.abs(self.multipliers).max() < 1.0)


def linear_loop(plant: Plant, loop: Sampled) -> SampledLoop:
    """The linear loop under the same controller."""
    if loop.measured:
        return sampled_loop(plant, Timing(loop.tau, loop.delay))
    lag = -1.0 / np.log(loop.kept) if loop.kept > 0.0 else 0.0
    return sampled_loop(plant, Timing(loop.tau, loop.delay, "filtered" if lag else "backward", lag or None))


def opened(plant: SimulatedActuator, opening: float) -> Plant:
    """The linear actuator with the damping that a valve open by |u| adds."""
    alpha, gamma, k = plant.actuator
    linear = linear_actuator(k, gamma)
    linear.a[2, 2] -= gamma * opening / (SQRT2 * alpha)
    return linear


def flip_at(plant: SimulatedActuator, loop: Sampled, opening: float = 0.0) -> float:
    """s at which a small orbit of that opening stands, to first order; at 0.0 the flip itself. inf: there is none."""
    return flip_gain(linear_loop(opened(plant, opening), loop), loop.d)


def softness(plant: SimulatedActuator, loop: Sampled) -> float:
    """ds/d|u| of the orbits at their birth. Positive where stability is lost with rising s: soft; negative: hard."""
    small = 1e-4 * plant.actuator.alpha / plant.actuator.gamma
    return (flip_at(plant, loop, small) - flip_at(plant, loop)) / small


def orbits(plant: SimulatedActuator, loop: Sampled, first: float = FIRST, longest: float = LONGEST) -> Iterator[Orbit]:
    """The branch of orbits from the flip on, whatever its s; ends where no more are found.

    `loop.s` is not used. Raises ValueError where the loop has no flip, ArithmeticError where even the first orbit is
    not found.
    """
    flip = flip_at(plant, loop)
    if not np.isfinite(flip):
        raise ValueError(f"no multiplier of this loop passes -1 at any s > 0: tau {loop.tau}, d {loop.d}")
    scale = scale_of(loop, plant)
    at, opening = _linear_orbit(plant, loop._replace(s=flip))
    size = first / np.abs(at / scale).max()
    z = np.append(
        (np.eye(len(at))[2:4].sum(axis=0) * 0.5 + size * at) / scale, 1.0 + _rise(plant, loop, size * opening)
    )
    along = np.append(at / scale, _rise(plant, loop, opening))
    of = equations(plant, loop, scale, flip)
    z = advance(z, along / np.linalg.norm(along), 0.0, of)[0]
    for point in branch(z, along, of, longest):
        yield _orbit(point.z[:-1] * scale, plant, loop._replace(s=float(point.z[-1] * flip)))


def _rise(plant: SimulatedActuator, loop: Sampled, opening: float) -> float:
    """s over the flip's, less 1, of a small orbit."""
    return softness(plant, loop) * opening / flip_at(plant, loop)


def _linear_orbit(plant: SimulatedActuator, loop: Sampled) -> tuple[Array, float]:
    """The motion with multiplier -1 at the flip, as a deviation of x, and its |u|."""
    matrix = closed(linear_loop(linear_actuator(plant.actuator.k, plant.actuator.gamma), loop), loop.s, loop.d)
    mu, vectors = np.linalg.eig(matrix)
    v = np.real(vectors[:, np.argmin(np.abs(mu + 1.0))])
    a, x = v[2] / (2.0 * plant.actuator.alpha), np.zeros(width_of(loop))
    x[:4], x[4:] = (v[0], v[1], a, -a), v[3:]
    return x, abs(command(x, loop._replace(limit=np.inf))[0])


def equations(plant: SimulatedActuator, loop: Sampled, scale: Array, flip: float) -> Equations:
    """P(P(x)) - x and its derivatives by (x, s), in units of `scale` and of the flip."""

    def of(z: Array) -> tuple[Array, Array]:
        at = loop._replace(s=float(z[-1] * flip))
        between, by_x, by_s = period(z[:-1] * scale, plant, at)
        after, by_between, by_s_again = period(between, plant, at)
        slopes = np.column_stack([by_between @ by_x * scale, (by_between @ by_s + by_s_again) * flip]) / scale[:, None]
        slopes[:, :-1] -= np.eye(len(scale))
        return after / scale - z[:-1], slopes

    return of


def _orbit(x: Array, plant: SimulatedActuator, loop: Sampled) -> Orbit:
    between, by_x, _ = period(x, plant, loop)
    _, again, _ = period(between, plant, loop)
    multipliers = np.linalg.eigvals(again @ by_x).astype(np.complex128)
    return Orbit(loop.s, np.array([x, between]), abs(command(x, loop)[0]), multipliers)
