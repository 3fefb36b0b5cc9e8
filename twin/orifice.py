"""Orifice between laminar and turbulent flow: Cd = c sqrt(Re/(Re + Re_t)), after Borutzky.

With Re = Q D/(A nu) the law is a quadratic, explicit both ways; the thesis iterates without need.
The hydraulic diameter is that of the round hole of the same area (assumed).
"""

import math
from typing import NamedTuple

from twin.kernel import inlined
from twin.oil import Oil

LEAST_AREA = 1e-30  # [m^2]; below it an opening is shut, since the square of a smaller one may vanish


class Orifice(NamedTuple):
    """A sharp edge of any opening."""

    discharge: float  # c [-], for fully turbulent flow
    transition: float  # Re_t [-]


@inlined
def resistance(area: float, orifice: Orifice, oil: Oil) -> tuple[float, float]:
    """(a, b) of dp = a Q|Q| + b Q, for an area [m^2] > 0; a [Pa s^2/m^6], b [Pa s/m^3]."""
    diameter = math.sqrt(4.0 * area / math.pi)
    a = oil.density / (2.0 * orifice.discharge**2 * area**2)
    return a, a * area * oil.viscosity * orifice.transition / diameter


@inlined
def quadratic_flow(drop: float, a: float, b: float) -> float:
    """Q [m^3/s] with a Q|Q| + b Q = drop, for a, b >= 0, not both zero. Free of cancellation."""
    if drop == 0.0:
        return 0.0
    size = abs(drop)
    return 2.0 * drop / (b + math.sqrt(b * b + 4.0 * a * size))


@inlined
def flow(drop: float, area: float, orifice: Orifice, oil: Oil) -> float:
    """Q [m^3/s] through an area [m^2] at a pressure drop [Pa]; odd in the drop, zero when shut."""
    if area <= LEAST_AREA:
        return 0.0
    a, b = resistance(area, orifice, oil)
    return quadratic_flow(drop, a, b)


def flow_slopes(drop: float, area: float, orifice: Orifice, oil: Oil) -> tuple[float, float]:
    """Slopes of the flow by the drop [m^3/(s Pa)] and by the area [m/s], for an area A > 0 (a ~ A^-2, b ~ A^-1.5)."""
    a, b = resistance(area, orifice, oil)
    q = quadratic_flow(drop, a, b)
    stiffness = 2.0 * a * abs(q) + b
    return 1.0 / stiffness, (2.0 * a * abs(q) + 1.5 * b) * q / (area * stiffness)


def area_for(rated_flow: float, drop: float, orifice: Orifice, oil: Oil) -> float:
    """The area [m^2] that passes a flow [m^3/s] at a drop [Pa]: the law solved for A, to rounding.

    A^2 - k sqrt(A) - A_t^2 = 0, A_t the turbulent area, rises for A > A_t: Newton from there cannot fail.
    """
    turbulent = rated_flow**2 * oil.density / (2.0 * orifice.discharge**2 * drop)
    k = turbulent / rated_flow * oil.viscosity * orifice.transition * math.sqrt(math.pi) / 2.0
    area = math.sqrt(turbulent)
    for _ in range(20):
        area -= (area**2 - k * math.sqrt(area) - turbulent) / (2.0 * area - 0.5 * k / math.sqrt(area))
    return area
