"""Steady lift and pressure of a valve with its volume, and the damping below which it sings.

With a1 = beta phi_1, a3 = beta phi_3 the characteristic polynomial is `l^3 + (k + a3) l^2 + (1 + k a3) l + a1 + a3`. A
pair crosses the imaginary axis where `a3 k^2 + (1 + a3^2) k - a1 = 0`, at `w^2 = 1 + a3 k`; without precompression
these are (4.14), (4.15), (4.42), (4.43) of the thesis, a1 = n z, a3 = z, n = 2 (chamfered) or 3 (conical).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from twin.chatter.system import SeatLaw, System


class Rest(NamedTuple):
    """An equilibrium; y2 = 0."""

    lift: float  # y1
    pressure: float  # y3 = y1 + e


class Onset(NamedTuple):
    """Where the valve begins to sing."""

    damping: float  # k_crit
    frequency: float  # w, in units of that of poppet and spring
    speed: float  # d Re(lambda)/dk < 0 there


def rest(s: System) -> Rest:
    """The equilibrium: y1^a (y1 + e)^b = q has one root. Raises ValueError without a flow or a volume."""
    if not (s.flow > 0.0 and s.beta > 0.0 and s.precompression >= 0.0):
        raise ValueError(
            f"flow {s.flow}, beta {s.beta}, precompression {s.precompression}: a valve that works needs a flow and "
            "beta above 0 and a precompression of at least 0"
        )
    law, e = s.law, s.precompression
    if e == 0.0:
        y = s.flow ** (1.0 / (law.lift + law.pressure))
        return Rest(y, y)

    def surplus(logarithm: float) -> float:
        return law.lift * logarithm + law.pressure * math.log(math.exp(logarithm) + e) - math.log(s.flow)

    none, alone = (
        math.log(s.flow) / (law.lift + law.pressure),
        (math.log(s.flow) - law.pressure * math.log(e)) / law.lift,
    )
    high = min(none, alone)  # as if there were no precompression, or nothing else
    low = (math.log(s.flow) - law.pressure * math.log(math.exp(high) + e)) / law.lift
    y = math.exp(float(brentq(surplus, low - 1e-9, high + 1e-9, xtol=1e-15)))  # pyright: ignore[reportArgumentType]
    return Rest(y, y + e)


def gains(s: System) -> tuple[float, float]:
    """a1 = beta phi_1, a3 = beta phi_3 at the equilibrium."""
    at = rest(s)
    return s.beta * s.law.lift * s.flow / at.lift, s.beta * s.law.pressure * s.flow / at.pressure


def jacobian(s: System) -> NDArray[np.float64]:
    """Of the three rates at the equilibrium, (3, 3)."""
    a1, a3 = gains(s)
    return np.array([[0.0, 1.0, 0.0], [-1.0, -s.damping, 1.0], [-a1, 0.0, -a3]])


def critical_damping(a1: float, a3: float) -> float:
    """k_crit: the positive root of a3 k^2 + (1 + a3^2) k - a1 = 0, free of cancellation. Below it the valve sings."""
    b = 1.0 + a3 * a3
    return 2.0 * a1 / (b + math.sqrt(b * b + 4.0 * a1 * a3))


def onset(s: System) -> Onset:
    """k_crit, frequency and crossing speed of a system; its own damping plays no part."""
    a1, a3 = gains(s)
    k = critical_damping(a1, a3)
    w = math.sqrt(1.0 + a3 * k)
    root = 1j * w
    slope = 3.0 * root**2 + 2.0 * (k + a3) * root + 1.0 + k * a3
    return Onset(k, w, (-(root**2 + a3 * root) / slope).real)


def growth(s: System) -> float:
    """Largest real part of the eigenvalues: > 0 where a small swing grows."""
    return float(np.linalg.eigvals(jacobian(s)).real.max())


def bare(z: float, law: SeatLaw) -> System:
    """The system without precompression that has a3 = z, at q = 1, where y1 = y3 = 1."""
    return System(law, z / law.pressure, 1.0, 0.0, 0.0, 1.0)


def crossing_speed(z: float, law: SeatLaw) -> float:
    """d Re(lambda)/dz at k_crit(z), no precompression: [(M - w^4)(M - w^2)]/[2 (w^4 (M - w^2) + M^2 (w^2 - 1))].

    M = n + 1. Zero at z = 1, where k_crit has its maximum: z parametrises no bifurcation there, the damping does.
    """
    n = law.lift / law.pressure
    k, m = critical_damping(n * z, z), n + 1.0
    w2 = 1.0 + k * z
    return (m - w2**2) * (m - w2) / (2.0 * (w2**2 * (m - w2) + m**2 * (w2 - 1.0)))
