"""Exact answers: the dissipative laminar line between any two ends, and waves without friction.

In Laplace's s, deviations from the steady start, n = sqrt(N(s)), g = s T n (`twin/lines/theory.py`), xi = x/L:

    p = A exp(-g xi) + B exp(-g (1 - xi)),      u = (A exp(-g xi) - B exp(-g (1 - xi)))/n

A and B from what the two ends hold. Bromwich's integral as one FFT brings it back to time.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.lines.lab.friction import Friction
from twin.lines.lab.pipe import PRESSURE, Case, Course, End, History, Pipe, steady_pressure
from twin.lines.theory import losses

Array = NDArray[np.float64]
Complex = Any  # NDArray[complex128], which numpy's own annotations lose on the way
POINTS = 2**17


def invert(transform: Any, span: float, count: int) -> Array:
    """f at t = 0, span/count, .., by the trapezoidal rule on twice the span [s]; transform: of an array of s.

    The contour at c damps what wraps round by exp(-2 c span) = 1e-10.
    """
    c = 5.0 * np.log(10.0) / span
    s = c + 1j * np.pi / span * np.arange(count + 1)
    values = transform(s)
    values[-1] = values[-1].real
    return np.fft.irfft(values, 2 * count)[:count] * np.exp(c * span / count * np.arange(count)) * count / span


def kind_of(model: Friction) -> str:
    """Which of `theory.LOSSES` a model stands for. ValueError for those without an exact answer."""
    if model.name in ("none", "steady"):
        return model.name
    if model.turbulent:
        raise ValueError(f"friction {model.name} is not linear and has no exact answer; take none, steady or zielke")
    return "unsteady"


def amplitudes(s: Complex, case: Case, n: Complex, left: Complex, right: Complex) -> tuple[Complex, Complex]:
    """A and B for what is held, transformed: pressure, or u."""
    e = np.exp(-s * case.pipe.travel_time * n)
    sign_l, x_l = (1.0, left) if case.left.holds == PRESSURE else (-1.0, n * left)
    sign_r, x_r = (1.0, right) if case.right.holds == PRESSURE else (-1.0, n * right)
    under = sign_r - sign_l * e * e
    return (sign_r * x_l - sign_l * e * x_r) / under, (x_r - e * x_l) / under


def transformed(end: End, hammer: float, before: float, s: Complex) -> Complex:
    """The transform of an end's deviation from its value [SI] before t = 0, in Pa. ValueError unless a `Course`."""
    if not isinstance(end.course, Course):
        raise ValueError("the exact answer needs ends whose course is a `Course`: straight between points")
    t, v = np.array(end.course.times), np.array(end.course.values)
    if t[0] < 0.0:
        raise ValueError(f"the exact answer starts at t = 0, but a course starts at {t[0]} s")
    slopes = np.diff(v) / np.diff(t)
    bends = np.diff(slopes, prepend=0.0, append=0.0)
    total = (v[0] - before) / s
    for at, bend in zip(t, bends, strict=True):
        total = total + bend * np.exp(-s * at) / s**2
    return total * (1.0 if end.holds == PRESSURE else hammer)


def exact_history(case: Case, friction: str, span: float, count: int, points: int = POINTS) -> History:
    """Both ends at t = 0, span/count, .., span. friction: none, steady or unsteady (laminar with memory)."""
    time = np.linspace(0.0, span, count + 1)
    first, last = (exact_field(case, friction, span, xi, points) for xi in (0.0, 1.0))
    fine = span / points * 1.05 * np.arange(points)
    p_1, p_2 = (np.interp(time, fine, field[0]) for field in (first, last))
    v_1, v_2 = (np.interp(time, fine, field[1]) / case.pipe.hammer for field in (first, last))
    return History(time, p_1, p_2, v_1, v_2)


def exact_field(case: Case, friction: str, span: float, xi: float, points: int = POINTS) -> tuple[Array, Array]:
    """p and u [Pa] at a place x = xi L, at 0, h, .., h = 1.05 span/points: a little more than the span [s]."""
    pipe, hammer = case.pipe, case.pipe.hammer
    rate = 0.0 if friction == "none" else pipe.steady_rate
    ends = steady_pressure(case, np.array([0.0, pipe.length]), rate)
    before = [p if end.holds == PRESSURE else case.velocity for end, p in zip((case.left, case.right), ends, strict=True)]

    def solution(s: Complex, row: int) -> Complex:
        n = np.sqrt(losses(s, pipe.viscous_time, friction))
        held = [transformed(e, hammer, b, s) for e, b in zip((case.left, case.right), before, strict=True)]
        a, b = amplitudes(s, case, n, *held)
        g = s * pipe.travel_time * n
        right, left = a * np.exp(-g * xi), b * np.exp(-g * (1.0 - xi))
        return right + left if row == 0 else (right - left) / n

    p, u = (invert(lambda s, row=row: solution(s, row), 1.05 * span, points) for row in (0, 1))
    return p + ends[0] + xi * (ends[1] - ends[0]), u + hammer * case.velocity


def transfer_matrix(s: Complex, pipe: Pipe, friction: str) -> Complex:
    """(.., 2, 2) of (p_1, Q_1) = T (p_2, Q_2), Q [m^3/s] from end 1 to end 2: the exact line at s [1/s]."""
    n = np.sqrt(losses(s, pipe.viscous_time, friction))
    g, z = s * pipe.travel_time * n, pipe.hammer / pipe.area * n
    return np.moveaxis(np.array([[np.cosh(g), z * np.sinh(g)], [np.sinh(g) / z, np.cosh(g)]]), (0, 1), (-2, -1))
