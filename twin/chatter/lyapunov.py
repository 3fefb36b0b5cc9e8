"""Soft or hard: the first Lyapunov coefficient of the valve at the damping where it begins to sing.

Kuznetsov's projection formula (Elements of Applied Bifurcation Theory, 5.4): A q = i w q, A^T p = -i w p, <p, q> = 1,
`l1 = Re{ <p, C(q,q,q*)> - 2 <p, B(q, A^-1 B(q,q*))> + <p, B(q*, (2iw - A)^-1 B(q,q))> }/(2w)`. Here q is scaled so that
its first entry is the steady lift: amplitudes are shares of the lift, and 1 would touch the seat. l1 < 0 is soft.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import brentq

from twin.chatter.equilibrium import bare, jacobian, onset, rest
from twin.chatter.system import SeatLaw, System, derivative

Vector = Any  # NDArray[complex128], which numpy's own annotations lose on the way


class _Forms:
    """The second and third derivatives of the third rate; those of the others are zero."""

    def __init__(self, s: System) -> None:
        at = rest(s)
        self.table = {
            (i, j): -s.beta * derivative(*at, (i, j), s.law) for i in range(4) for j in range(4) if 2 <= i + j <= 3
        }

    def b(self, x: Vector, y: Vector) -> Vector:
        t = self.table
        form = t[2, 0] * x[0] * y[0] + t[1, 1] * (x[0] * y[2] + x[2] * y[0]) + t[0, 2] * x[2] * y[2]
        return np.array([0.0, 0.0, form])

    def c(self, x: Vector, y: Vector, w: Vector) -> Vector:
        t = self.table
        twice = x[0] * y[0] * w[2] + x[0] * y[2] * w[0] + x[2] * y[0] * w[0]
        once = x[0] * y[2] * w[2] + x[2] * y[0] * w[2] + x[2] * y[2] * w[0]
        cubic = t[3, 0] * x[0] * y[0] * w[0] + t[2, 1] * twice + t[1, 2] * once + t[0, 3] * x[2] * y[2] * w[2]
        return np.array([0.0, 0.0, cubic])


def first_coefficient(s: System) -> float:
    """l1 of a system at its own k_crit; its own damping plays no part."""
    return sum(_terms(s))


def _terms(s: System) -> tuple[float, float, float]:
    """l1 in parts: the cubic one, the quadratic one within the plane of the swing, that by way of the third axis."""
    start = onset(s)
    matrix, w, one = jacobian(s._replace(damping=start.damping)), start.frequency, np.eye(3)
    q = _null(matrix - 1j * w * one)
    q = q * (rest(s).lift / q[0])
    p = _null(matrix.T + 1j * w * one)
    p = p / np.conj(np.vdot(p, q))
    form, star = _Forms(s), q.conj()
    level = np.linalg.solve(matrix, form.b(q, star))
    twice = np.linalg.solve(2j * w * one - matrix, form.b(q, q))
    quadratic = form.b(star, twice) - 2.0 * form.b(q, level)
    cubic, all_quadratic = (float(np.vdot(p, part).real) / (2.0 * w) for part in (form.c(q, q, star), quadratic))
    plane = float((1j * np.vdot(p, form.b(q, q)) * np.vdot(p, form.b(q, star))).real) / (2.0 * w * w)
    return cubic, plane, all_quadratic - plane


def _null(matrix: Vector) -> Vector:
    """The vector that a singular matrix makes zero."""
    return np.linalg.svd(matrix)[2][-1].conj()


def damping_by_amplitude(s: System) -> float:
    """c of k = k_crit + c a^2, a the amplitude of the lift over the steady lift: -w l1/(4 dRe/dk). c < 0 is soft.

    Small z, no precompression: -21/8 z for the conical seat, but -11/2 z^5 for the chamfered: there the flow
    is linear in the lift, and k_crit hardly depends on the amplitude.
    """
    start = onset(s)
    return -start.frequency * first_coefficient(s) / (4.0 * start.speed)


def change(law: SeatLaw) -> float:
    """z, without precompression, at which a soft loss of stability turns hard: the root of l1."""
    return _root(lambda z: first_coefficient(bare(z, law)), law)


def turned_change(law: SeatLaw) -> float:
    """The same with the quadratic term of the plane turned round, as by the other sense of rotation in its formula.

    For the chamfered seat 1.3253: the nearest that was found to the thesis's 1.323.
    """

    def coefficient(z: float) -> float:
        cubic, plane, beside = _terms(bare(z, law))
        return cubic - plane + beside

    return _root(coefficient, law)


def _root(coefficient: Callable[[float], float], law: SeatLaw) -> float:
    low, high = 1.0, 1.0
    while coefficient(high) < 0.0:
        low, high = high, 1.5 * high
        if high > 1e4:
            raise ValueError(f"the loss of stability stays soft up to z = {high:.3g} with exponents {tuple(law)}")
    return float(brentq(coefficient, low, high, xtol=1e-13))  # pyright: ignore[reportArgumentType]


def relative_amplitude(s: System) -> float:
    """Amplitude of the lift over the steady lift of a soft cycle at the system's own damping, to first order."""
    short, c = s.damping - onset(s).damping, damping_by_amplitude(s)
    return math.sqrt(short / c) if short * c > 0.0 else math.nan
