"""Pilot poppet of the relief valve: a spring-loaded cone on a sharp seat, p2 below it, the tank behind it.

Symbols and signs: `README.md`, after (2.20), (2.25), (2.26), (2.32) to (2.34), (2.41) to (2.44) of the
source. Lift x >= 0 from the seat, pressures gauge, tank at zero. The loss law is fitted to lifts of 0.01 to 0.1 seat
diameters; at work the valve opens 0.001 to 0.0025, so results there extrapolate it.
"""

import math
from typing import NamedTuple

from twin.contact import Stops
from twin.kernel import kernel
from twin.oil import Oil
from twin.relief.long_seat import (
    LongSeat,
    long_area,
    long_conductance,
    long_damping,
)
from twin.seats.frustum import frustum_area


class Poppet(NamedTuple):
    """Cone, spring and seat."""

    mass: float  # m [kg], a third of the spring included, (2.42)
    stiffness: float  # s [N/m]
    preload: float  # s x0 [N], the spring's force on the seat
    drag: float  # K [N s/m], oil on the spring, (2.44)
    diameter: float  # d_in [m], of the seat
    area: float  # A_in [m^2], pi/4 d_in^2
    sine: float  # sin alpha, alpha half the cone's angle
    cosine: float  # cos alpha
    conductance: float  # R/x^n [m^(3-n)/(s sqrt(Pa))]
    exponent: float  # n [-], half that of the loss law
    head: float  # rho/A_in^2 [kg/m^7]
    stops: Stops  # seat and upper stop
    shut_area: float  # [m^2], on which p2 acts while shut
    long: LongSeat  # in place of the chamfered seat


def poppet(
    oil: Oil,
    *,
    mass: float,
    stiffness: float,
    precompression: float,
    spring_diameter: float,
    spring_turns: float,
    diameter: float,
    angle: float,
    loss_factor: float,
    loss_exponent: float,
    stops: Stops,
    long: LongSeat,
) -> Poppet:
    """The poppet of these numbers; zeta = loss_factor (d_in/x)^loss_exponent, angle [rad] half the cone's."""
    area = math.pi / 4.0 * diameter**2
    exponent = 0.5 * loss_exponent
    return Poppet(
        mass=mass,
        stiffness=stiffness,
        preload=stiffness * precompression,
        drag=spring_drag(spring_diameter, spring_turns, oil),
        diameter=diameter,
        area=area,
        sine=math.sin(angle),
        cosine=math.cos(angle),
        conductance=area * math.sqrt(2.0 / (oil.density * loss_factor)) / diameter**exponent,
        exponent=exponent,
        head=oil.density / area**2,
        stops=stops,
        shut_area=long_area(0.0, long) if long.fitted == 1.0 else area,
        long=long,
    )


def spring_drag(diameter: float, turns: float, oil: Oil) -> float:
    """K [N s/m] of oil on a spring of a diameter [m], (2.44): 3/2 mu D pi n."""
    return 1.5 * oil.density * oil.viscosity * diameter * math.pi * turns


@kernel
def gape(lift: float, poppet: Poppet) -> tuple[float, float]:
    """R [m^3/(s sqrt(Pa))] of Q = R sqrt(p2), (2.25), (2.26), and the area [m^2] on which p2 acts, at a lift.

    The momentum force rho Q^2 (1/A_in - cos a/A_pl), (2.33), is proportional to p2 by Q^2 = R^2 p2. So both fluid
    forces are one: A_in (1 + 2/zeta (1 - A_in cos a/A_pl)) p2. In a reversed flow its sign turns (assumed). R is 0.0
    with a long seat, whose flow is that of `seep`.
    """
    if lift <= 0.0:
        return 0.0, poppet.shut_area
    if poppet.long.fitted == 1.0:
        return 0.0, long_area(lift, poppet.long)
    conductance = poppet.conductance * lift**poppet.exponent
    narrowing = poppet.area * poppet.cosine / frustum_area(lift, poppet.diameter, poppet.sine, poppet.cosine)
    return conductance, poppet.area * (1.0 + conductance**2 * poppet.head * (1.0 - narrowing))


@kernel
def spring_force(lift: float, poppet: Poppet) -> float:
    """Force of the spring towards the seat [N]."""
    return poppet.preload + poppet.stiffness * lift


@kernel
def cracking_pressure(poppet: Poppet) -> float:
    """p2 [Pa] up to which the spring holds the poppet on its seat."""
    return poppet.preload / poppet.shut_area


@kernel
def seep(lift: float, poppet: Poppet) -> float:
    """G [m^3/(s Pa)] of the laminar flow Q = G p2 through a long seat; 0.0 where there is none."""
    if lift <= 0.0 or poppet.long.fitted == 0.0:
        return 0.0
    return long_conductance(lift, poppet.long)


@kernel
def poppet_drag(lift: float, poppet: Poppet) -> float:
    """K [N s/m] of the oil on the spring, and of that in the gap of a long seat."""
    if poppet.long.fitted == 0.0:
        return poppet.drag
    return poppet.drag + long_damping(lift, poppet.long)
