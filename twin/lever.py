"""A lever: mass and force on the piston that change with its position, as of a boom.

    m(x) x'' + m'(x) x'^2/2 = F_oil + F(x) + F_ext + environment - friction

m(x): moment of inertia over the square of the lever arm, the piston's own mass added; F(x): the force of gravity on the
piston, whose potential is its integral. The term with m' keeps the kinetic energy m(x) x'^2/2 where no force acts. So
the travel of a step keeps it: x changes at the speed that it has midway, and the speed then follows from the energy;
kicks act on m at their place. Of second order, symmetric, and without energy of its own.
"""

import math
from typing import NamedTuple

from twin.environment import Environment
from twin.kernel import inlined
from twin.table import Curve, value_and_slope

ITERATIONS = 3  # for the place midway; m changes little in a step


class Lever(NamedTuple):
    """Tables over the position, and what acts besides."""

    piston: float  # mass of the piston [kg]
    inertia: Curve  # of the load, seen from the piston [kg]
    lift: Curve  # F(x) [N]
    gravity: float  # g [m/s^2], of the piston alone
    force: float  # F_ext [N], at the piston
    around: Environment  # at the piston


@inlined
def lever_mass(position: float, load: Lever) -> float:
    """m(x) [kg]."""
    return load.piston + value_and_slope(position, load.inertia)[0]


@inlined
def lever_force(position: float, load: Lever) -> float:
    """Force of gravity on the piston [N]."""
    return value_and_slope(position, load.lift)[0] - load.piston * load.gravity


@inlined
def glide(position: float, speed: float, load: Lever, time: float) -> tuple[float, float]:
    """Mean speed [m/s] of a travel of a time [s] that keeps m(x) v^2, and the root of the mass before it."""
    root = math.sqrt(lever_mass(position, load))
    mean = speed
    for _ in range(ITERATIONS):
        mean = speed * root / math.sqrt(lever_mass(position + 0.5 * time * mean, load))
    return mean, root
