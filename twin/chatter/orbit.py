"""Periodic orbits of the valve that keep clear of its seat: shooting, followed from the equilibrium to the seat.

An orbit starts where its lift turns, at y1 = y_e (1 - depth), y2 = 0: depth > 0 is its lowest point, depth < 0 its
highest, depth 1 touches the seat. Unknown are y3 there, the period, and one parameter of the system, its damping or its
flow; Newton's method with the variational equation. Independent of the projection formula: `curvature` gives the
coefficient of `lyapunov.damping_by_amplitude` by orbits alone.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from twin.chatter.equilibrium import bare, onset, rest
from twin.chatter.system import SeatLaw, System, derivative, outflow
from twin.integration import integrate
from twin.kernel import interpreted

Array = NDArray[np.floating]
TOLERANCE = 3e-14  # of the integration, relative
MOST = 100_000  # evaluations of the rates per integration; an orbit takes some thousand
CLOSE = 1e-8  # relative: a smaller correction is the last, its error is of its square
AMPLITUDES = (0.03, 0.05, 0.08, 0.11)  # of `curvature`
FREE = ("damping", "flow")


class Orbit(NamedTuple):
    """A periodic orbit and the system that has it."""

    system: System
    depth: float
    pressure: float  # y3 at the start
    period: float

    @property
    def start(self) -> Array:
        return np.array([rest(self.system).lift * (1.0 - self.depth), 0.0, self.pressure])


def variation(start: Array, time: float, s: System, free: str, tolerance: float = TOLERANCE) -> tuple[Array, Array]:
    """The state after a time, (3), and its derivatives by the start and by the free parameter, (3, 4)."""

    def slope(_: float, y: Array) -> Array:
        y1, y2, y3 = y[:3]
        motion = np.array([y2, -s.damping * y2 - y1 - s.precompression + y3, s.beta * (s.flow - _phi(y1, y3, s.law))])
        by = _slopes(y1, y3, s.law)
        matrix = np.array([[0.0, 1.0, 0.0], [-1.0, -s.damping, 1.0], [-s.beta * by[0], 0.0, -s.beta * by[1]]])
        columns = matrix @ y[3:].reshape(3, 4)
        columns[:, 3] += (0.0, -y2, 0.0) if free == "damping" else (0.0, 0.0, s.beta)
        return np.concatenate([motion, columns.ravel()])

    begin = np.concatenate([start, np.eye(3, 4).ravel()])
    scale = 1e-2 * tolerance * max(start[2], 1e-6)
    run = integrate(slope, (0.0, time), begin, "DOP853", most=MOST, rtol=tolerance, atol=scale, first_step=0.05)
    end = run.y[:, -1]
    return end[:3], end[3:].reshape(3, 4)


def _phi(y1: float, y3: float, law: SeatLaw) -> float:
    return interpreted(outflow)(y1, y3, law)


def _slopes(y1: float, y3: float, law: SeatLaw) -> tuple[float, float]:
    """First derivatives of phi; also at and a little below the seat, where Newton's method may look."""
    y3 = max(y3, 1e-12)
    by_lift = 1.0 if law.lift == 1.0 else law.lift * y1 ** (law.lift - 1.0)
    return by_lift * y3**law.pressure, y1**law.lift * derivative(1.0, y3, (0, 1), law)


def orbit(guess: Orbit, depth: float, free: str, tolerance: float = TOLERANCE) -> Orbit:
    """The orbit of a depth near a guess, its damping or flow found with it. Raises ValueError where none is near."""
    s, y3, period = guess.system, guess.pressure, guess.period
    for _ in range(12):
        at = rest(s)
        start = np.array([at.lift * (1.0 - depth), 0.0, y3])
        end, by = variation(start, period, s, free, tolerance)
        # y_e depends on a free flow: y_e' = (y_e/q)/(a + b y_e/(y_e + e))
        lift_slope = 0.0
        if free == "flow":
            lift_slope = at.lift / s.flow / (s.law.lift + s.law.pressure * at.lift / at.pressure)
        moved = (1.0 - depth) * lift_slope
        flowing = np.array(_motion(end, s))
        slope = np.column_stack([by[:, 2] - (0.0, 0.0, 1.0), flowing, by[:, 3] + by[:, 0] * moved - (moved, 0.0, 0.0)])
        change = np.linalg.solve(slope, start - end)
        y3, period = y3 + change[0], period + change[1]
        value = getattr(s, free) + float(change[2])
        if not (period > 0.0 and y3 > 0.0 and (free == "damping" or value > 0.0)):
            break
        s = s._replace(**{free: value})
        if np.abs(change / (at.pressure, period, value)).max() < CLOSE:
            return Orbit(s, depth, float(y3), float(period))
    raise ValueError(f"no periodic orbit of depth {depth} found near {free} = {getattr(guess.system, free):.6g}")


def _motion(y: Array, s: System) -> tuple[float, float, float]:
    lift = -s.damping * y[1] - y[0] - s.precompression + y[2]
    return y[1], lift, s.beta * (s.flow - _phi(y[0], y[2], s.law))


def small(s: System, depth: float) -> Orbit:
    """The linear guess of an orbit of a small depth, at k_crit of the system."""
    start, at = onset(s), rest(s)
    w = start.frequency
    pressure = at.pressure + (1.0 - w * w) * -depth * at.lift  # y3 = (1 - w^2 + i k w) y1 in the linear swing
    return Orbit(s._replace(damping=start.damping), depth, pressure, 2.0 * math.pi / w)


def small_of_flow(s: System, depth: float) -> Orbit:
    """The same where the damping is given and the flow is the critical one: the least of all that k_crit allows.

    Raises ValueError where no flow has k_crit equal to the damping.
    """
    low, high = 1e-9, 1e-9
    while onset(s._replace(flow=high)).damping < s.damping:
        low, high = high, 2.0 * high
        if high > 1e6:
            raise ValueError(f"no flow makes a damping of {s.damping:.4g} critical: the valve is always calm")
    if low == high:
        raise ValueError(f"a damping of {s.damping:.4g} is below k_crit at any flow: the valve always sings")
    q = brentq(lambda flow: onset(s._replace(flow=flow)).damping - s.damping, low, high, xtol=1e-15)
    return small(s._replace(flow=float(q)), depth)  # pyright: ignore[reportArgumentType]


def follow(first: Orbit, depths: Array, free: str, tolerance: float = TOLERANCE) -> list[Orbit]:
    """The orbits of rising depths, each from the two before it."""
    found = [orbit(first, float(depths[0]), free, tolerance)]
    for depth in depths[1:]:
        guess = found[-1]
        if len(found) > 1:
            a, b = found[-2], found[-1]
            share = (depth - b.depth) / (b.depth - a.depth)
            value = getattr(b.system, free) + share * (getattr(b.system, free) - getattr(a.system, free))
            guess = Orbit(
                b.system._replace(**{free: value}),
                float(depth),
                b.pressure + share * (b.pressure - a.pressure),
                b.period + share * (b.period - a.period),
            )
        found.append(orbit(guess, float(depth), free, tolerance))
    return found


def curvature(s: System) -> float:
    """c of k = k_crit + c a^2 as a -> 0, by orbits: the even part of k over the depth, extrapolated."""
    k0 = onset(s).damping
    even = []
    for sign in (1.0, -1.0):
        orbits = follow(small(s, sign * AMPLITUDES[0]), sign * np.array(AMPLITUDES), "damping")
        even.append([o.system.damping - k0 for o in orbits])
    squares = np.array(AMPLITUDES) ** 2
    values = np.mean(even, axis=0) / squares
    return float(np.polynomial.polynomial.polyfit(squares, values, len(squares) - 1)[0])


def change_by_orbits(law: SeatLaw, low: float, high: float) -> float:
    """z at which soft turns hard, by the orbits' curvature alone, between two values."""
    return float(brentq(lambda z: curvature(bare(z, law)), low, high, xtol=1e-9))  # pyright: ignore[reportArgumentType]
