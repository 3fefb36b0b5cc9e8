"""A pipe, what is held at its two ends, how it starts, and what a run of it gives."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.oil import effective_modulus

Array = NDArray[np.floating]
PRESSURE, VELOCITY = "pressure", "velocity"


class Pipe(NamedTuple):
    """A round pipe filled with oil."""

    length: float  # L [m]
    diameter: float  # inner, 2 R [m]
    speed: float  # a [m/s], of waves
    density: float  # rho [kg/m^3]
    viscosity: float  # nu [m^2/s]

    @property
    def travel_time(self) -> float:
        """T = L/a [s]."""
        return self.length / self.speed

    @property
    def viscous_time(self) -> float:
        """t_v = R^2/nu [s]."""
        return self.diameter**2 / (4.0 * self.viscosity)

    @property
    def area(self) -> float:
        """A [m^2]."""
        return np.pi / 4.0 * self.diameter**2

    @property
    def hammer(self) -> float:
        """rho a [Pa s/m]: Joukowsky's pressure of a change of speed."""
        return self.density * self.speed

    @property
    def steady_rate(self) -> float:
        """8 nu/R^2 [1/s]: Hagen-Poiseuille friction over u."""
        return 8.0 / self.viscous_time


def elastic(pipe: Pipe, bulk_modulus: float, wall: float, young: float) -> Pipe:
    """The pipe with the wave speed of oil [Pa] in an elastic wall [m], Young's modulus [Pa], (2.8)."""
    modulus = effective_modulus(bulk_modulus, pipe.diameter, wall, young)
    return pipe._replace(speed=float(np.sqrt(modulus / pipe.density)))


class Course(NamedTuple):
    """A course in time, straight between its points and constant outside; has an exact Laplace transform."""

    times: tuple[float, ...]  # [s], increasing
    values: tuple[float, ...]

    def __call__(self, t: float) -> float:
        return float(np.interp(t, self.times, self.values))


def constant(value: float) -> Course:
    """Always the same."""
    return Course((0.0,), (value,))


def ramp(before: float, after: float, duration: float) -> Course:
    """From one value to another within a duration [s] from t = 0; a jump at t = 0 if that is 0."""
    return Course((0.0, duration), (before, after)) if duration > 0.0 else constant(after)


class End(NamedTuple):
    """What is held at an end: pressure [Pa] or velocity [m/s, from end 1 to end 2] over time [s]."""

    holds: str  # PRESSURE or VELOCITY
    course: Callable[[float], float]


def sampled(end: End, times: Array) -> Array:
    """What an end holds at some times [s], in SI."""
    if isinstance(end.course, Course):
        return np.interp(times, end.course.times, end.course.values)
    return np.array([end.course(float(t)) for t in times])


def closed() -> End:
    """A shut end."""
    return End(VELOCITY, constant(0.0))


def reservoir(pressure: float) -> End:
    """Constant pressure [Pa]."""
    return End(PRESSURE, constant(pressure))


class Case(NamedTuple):
    """A pipe between two ends, steady up to t = 0. An end whose course starts elsewhere jumps there at t = 0."""

    pipe: Pipe
    left: End  # end 1, x = 0
    right: End  # end 2, x = L
    velocity: float  # [m/s] of the steady flow
    pressure: float  # [Pa] before t = 0, at end 1 if only that holds pressure, else at end 2

    @property
    def anchored_left(self) -> bool:
        """Whether `pressure` is that of end 1."""
        return self.left.holds == PRESSURE and self.right.holds != PRESSURE


def steady_pressure(case: Case, x: Array, friction_rate: float) -> Array:
    """Pressure [Pa] at places x [m] before t = 0; friction_rate: steady friction over u [1/s], 0 without friction."""
    slope = -friction_rate * case.pipe.hammer * case.velocity / case.pipe.speed
    return case.pressure + slope * (x - (0.0 if case.anchored_left else case.pipe.length))


class History(NamedTuple):
    """Both ends over time; arrays of one length."""

    time: Array  # [s]
    p_1: Array  # [Pa]
    p_2: Array  # [Pa]
    v_1: Array  # [m/s]
    v_2: Array  # [m/s]


def mirrored(case: Case) -> Case:
    """The same pipe seen from the other side: ends swapped, velocities turned round."""

    def turned(end: End) -> End:
        if end.holds == PRESSURE:
            return end
        if isinstance(end.course, Course):
            return End(VELOCITY, end.course._replace(values=tuple(-v for v in end.course.values)))
        return End(VELOCITY, lambda t: -end.course(t))

    other = case._replace(left=turned(case.right), right=turned(case.left), velocity=-case.velocity)
    if other.anchored_left == case.anchored_left:
        raise ValueError("mirroring needs exactly one end that holds pressure, so that the start is known at it")
    return other
