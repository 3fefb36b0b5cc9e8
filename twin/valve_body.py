"""The moving body of a valve on its spring: with a mass and two stops, or as a first-order lag.

Mass: m x'' = F - k x - d x', 0 <= x <= travel; F, what opens less the preload, straight within a step as it was in the
last one (the pressures at its end are not known yet), so the whole is of second order. Substeps by the midpoint rule,
which keeps the energy of spring and mass whatever the step; their number follows from the body's own frequency. An
impact happens at its own instant, under a constant acceleration; one that would end within the substep is dead.
Lag: T x' = F/k within the stops - x, exact for a constant F.

What the body displaces is not counted: 0.1 cm^3 beside the oil of a chamber.
"""

import math
from typing import Any, NamedTuple

from twin.contact import Stops
from twin.kernel import by_type, inlined

TURN = 0.25  # [rad], of the body's own swing in a substep
MOST_SUBSTEPS = 40


class Mass(NamedTuple):
    """A body with inertia."""

    mass: float  # m [kg]
    damping: float  # d [N s/m]
    stiffness: float  # k [N/m]
    stops: Stops
    substeps: float


class FirstOrder(NamedTuple):
    """A body that follows its steady lift."""

    kept: float  # share of the distance that is left after a step
    rate: float  # k [N/m]
    travel: float  # [m]


Body = Mass | FirstOrder


def mass_body(mass: float, damping: float, stiffness: float, stops: Stops, step: float) -> Mass:
    """The body, with as many substeps as its swing on the spring needs."""
    turns = step * math.sqrt(stiffness / mass)
    return Mass(mass, damping, stiffness, stops, float(min(max(math.ceil(turns / TURN - 1e-9), 1), MOST_SUBSTEPS)))


def first_order_body(time_constant: float, stiffness: float, travel: float, step: float) -> FirstOrder:
    """The lag; a time constant [s] of 0 follows at once."""
    return FirstOrder(math.exp(-step / time_constant) if time_constant > 0.0 else 0.0, stiffness, travel)


@by_type
def move_body(body: Any, lift: float, speed: float, force: float, gain: float, step: float) -> tuple[float, float]:
    """Lift [m] and speed [m/s] a step [s] later, under a force [N] that grows by `gain` [N] in the step."""
    raise TypeError(f"{body} is not a body")


@move_body.register
def _(body: Mass, lift: float, speed: float, force: float, gain: float, step: float) -> tuple[float, float]:
    count = int(body.substeps)
    h = step / count
    inertia, resisting = body.mass / h, 0.5 * body.damping + 0.25 * h * body.stiffness
    for i in range(count):
        push = force + gain * (i + 0.5) / count - body.stiffness * lift
        then = ((inertia - resisting) * speed + push) / (inertia + resisting)
        moved = lift + 0.5 * h * (speed + then)
        if 0.0 <= moved <= body.stops.stroke:
            lift, speed = moved, then
        else:
            lift, speed = bounce(lift, speed, (then - speed) / h, body.stops, h)
    return lift, speed


@move_body.register
def _(body: FirstOrder, lift: float, speed: float, force: float, gain: float, step: float) -> tuple[float, float]:
    target = min(max((force + 0.5 * gain) / body.rate, 0.0), body.travel)
    return target + body.kept * (lift - target), 0.0


@inlined
def bounce(lift: float, speed: float, acceleration: float, stops: Stops, time: float) -> tuple[float, float]:
    """Lift and speed after a time [s] in which the body meets a stop under a constant acceleration [m/s^2]."""
    upper = lift + time * (speed + 0.5 * time * acceleration) > stops.stroke
    stop, sign = (stops.stroke, 1.0) if upper else (0.0, -1.0)
    gap, u, a = abs(stop - lift), sign * speed, sign * acceleration
    impact = math.sqrt(max(0.0, u * u + 2.0 * a * gap))
    left = time - ((impact - u) / a if u < 0.0 else 2.0 * gap / max(u + impact, 1e-300))
    back = stops.restitution * impact
    if impact <= stops.rest_speed or back <= left * a:
        return stop, 0.0
    there = stop - sign * left * (back - 0.5 * left * a)
    return min(max(there, 0.0), stops.stroke), -sign * (back - left * a)


@by_type
def steady_lift(body: Any, force: float) -> float:
    """Lift [m] at rest under a force [N]."""
    raise TypeError(f"{body} is not a body")


@steady_lift.register
def _(body: Mass, force: float) -> float:
    return min(max(force / body.stiffness, 0.0), body.stops.stroke)


@steady_lift.register
def _(body: FirstOrder, force: float) -> float:
    return min(max(force / body.rate, 0.0), body.travel)
