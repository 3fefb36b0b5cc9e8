"""Exact answers: the dissipative laminar line between any two ends, and waves without friction.

In Laplace's s, deviations from the steady start, n = sqrt(N(s)), g = s T n (`twin/lines/theory.py`), xi = x/L:

    p = A exp(-g xi) + B exp(-g (1 - xi)),      u = (A exp(-g xi) - B exp(-g (1 - xi)))/n

A and B from what the two ends hold. Bromwich's integral as one FFT brings it back to time.
"""

from typing import Any

import numpy as np

from twin.lines.lab.friction import Friction
from twin.lines.lab.pipe import PRESSURE, Array, Case, Course, End, History, Pipe, steady_pressure
from twin.lines.theory import losses

Complex = Any  # NDArray[complex128], which numpy's own annotations lose on the way
POINTS = 2**16


def invert(transform: Any, span: float, count: int) -> Array:
    """f at t = 0, span/count, .., of a transform, a function of an array of s."""
    return to_time(transform(contour(span, count)), span)


def contour(span: float, count: int) -> Complex:
    """count + 1 points s on Bromwich's line; its place damps what wraps round twice the span [s] to 1e-10."""
    return 5.0 * np.log(10.0) / span + 1j * np.pi / span * np.arange(count + 1)


def to_time(values: Complex, span: float) -> Array:
    """f at t = 0, span/count, .., of its transform on the contour, by the trapezoidal rule."""
    count = len(values) - 1
    rate = 5.0 * np.log(10.0) / count
    even = np.append(values[:-1], values[-1].real)
    return np.fft.irfft(even, 2 * count)[:count] * np.exp(rate * np.arange(count)) * count / span


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
    fine, p, u = exact_field(case, friction, span, np.array([0.0, 1.0]), points)
    ends = [np.interp(time, fine, row) for row in (p[0], p[1], u[0] / case.pipe.hammer, u[1] / case.pipe.hammer)]
    return History(time, *ends)


def exact_field(case: Case, friction: str, span: float, xi: Array, points: int = POINTS) -> tuple[Array, Array, Array]:
    """Times [s], p and u [Pa] at places x = xi L, (len(xi), points): times go a little beyond the span [s].

    ValueError: a course that is not a `Course`, or starts before t = 0.
    """
    pipe, hammer, beyond = case.pipe, case.pipe.hammer, 1.05 * span
    ends = steady_pressure(case, np.array([0.0, pipe.length]), 0.0 if friction == "none" else pipe.steady_rate)
    both = zip((case.left, case.right), ends, strict=True)
    before = [float(p) if end.holds == PRESSURE else case.velocity for end, p in both]
    s = contour(beyond, points)
    n = np.sqrt(losses(s, pipe.viscous_time, friction))
    held = [transformed(e, hammer, b, s) for e, b in zip((case.left, case.right), before, strict=True)]
    a, b = amplitudes(s, case, n, held[0], held[1])
    g, p, u = s * pipe.travel_time * n, [], []
    for place in xi:
        right, left = a * np.exp(-g * place), b * np.exp(-g * (1.0 - place))
        p.append(to_time(right + left, beyond) + ends[0] + place * (ends[1] - ends[0]))
        u.append(to_time((right - left) / n, beyond) + hammer * case.velocity)
    return beyond / points * np.arange(points), np.array(p), np.array(u)


def transfer_matrix(s: Complex, pipe: Pipe, friction: str) -> Complex:
    """(.., 2, 2) of (p_1, Q_1) = T (p_2, Q_2), Q [m^3/s] from end 1 to end 2: the exact line at s [1/s]."""
    n = np.sqrt(losses(s, pipe.viscous_time, friction))
    g, z = s * pipe.travel_time * n, pipe.hammer / pipe.area * n
    return np.moveaxis(np.array([[np.cosh(g), z * np.sinh(g)], [np.sinh(g) / z, np.cosh(g)]]), (0, 1), (-2, -1))
