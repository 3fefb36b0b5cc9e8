"""Seal friction of piston and rod: F = g(z) p_w b pi (D + d), z = mu v/(p_w b), after Bisztray-Balku.

Source: (2.13), (2.14) and the text below. It falls with speed (stick-slip) and is set-valued at rest. The thesis
measured another friction downwards than upwards, and puts it down to a seal that is not symmetric.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined


class Seal(NamedTuple):
    """The power law g = alpha z^beta and the limit it is cut at."""

    alpha: float
    beta: float  # < 0
    limit: float  # g_max [-]; 0.0 switches the friction off
    width: float  # b [m]
    perimeter: float  # pi (D + d) [m]
    downward: float  # friction on the way down over that on the way up [-]
    viscosity: float  # dynamic, mu [Pa s]
    plateau: float  # z below which g is at its limit


def seal(
    alpha: float, beta: float, limit: float, width: float, perimeter: float, downward: float, viscosity: float
) -> Seal:
    """A seal; the end of its plateau follows from the power law."""
    plateau = math.exp(min(700.0, math.log(limit / alpha) / beta)) if limit > 0.0 else math.inf
    return Seal(alpha, beta, limit, width, perimeter, downward, viscosity, plateau)


def least_mass(seal: Seal, time: float) -> float:
    """Mass [kg] above which a kick of `time` [s] has one answer: friction must not fall faster than inertia holds."""
    if seal.limit == 0.0:
        return 0.0
    most = max(1.0, seal.downward) * seal.limit * seal.perimeter
    return 0.5 * time * -seal.beta * most * seal.viscosity / seal.plateau


@inlined
def share(direction: float, seal: Seal) -> float:
    """Friction in a direction of the motion, or of the push at rest, over that upwards."""
    return seal.downward if direction < 0.0 else 1.0


@inlined
def friction_limit(direction: float, sealing_pressure: float, seal: Seal) -> float:
    """Largest friction [N] against a direction, at rest and at the lowest speeds."""
    return seal.limit * sealing_pressure * seal.width * seal.perimeter * share(direction, seal)


@inlined
def friction(speed: float, sealing_pressure: float, seal: Seal) -> tuple[float, float]:
    """Friction [N], positive, at a speed != 0 [m/s], and its slope by speed in the direction of motion [N s/m]."""
    most = friction_limit(speed, sealing_pressure, seal)
    load = sealing_pressure * seal.width
    z = seal.viscosity * abs(speed)
    if z <= seal.plateau * load:
        return most, 0.0
    force = seal.alpha * math.exp(seal.beta * math.log(z / load)) * load * seal.perimeter * share(speed, seal)
    return force, seal.beta * force / abs(speed)


@inlined
def slide(speed: float, drive: float, mass: float, sealing_pressure: float, seal: Seal, time: float) -> float:
    """Speed [m/s] after a time [s] under a constant drive [N] and the friction.

    Sliding: trapezoidal rule, linearised. Where that would turn the motion round: rest, if the largest friction
    can hold; else away from rest against it. A mass at rest stays exactly at rest.
    """
    if seal.limit == 0.0 or sealing_pressure == 0.0:
        return speed + time * drive / mass
    if speed != 0.0:
        direction = math.copysign(1.0, speed)
        force, slope = friction(speed, sealing_pressure, seal)
        then = speed + time * (drive - direction * force) / (mass + 0.5 * time * slope)
        if then * direction > 0.0:
            return then
    push = mass * speed / time + drive
    return time / mass * math.copysign(max(0.0, abs(push) - friction_limit(push, sealing_pressure, seal)), push)
