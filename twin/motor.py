"""Hydraulic motor: a shaft that oil turns, with leaks into its case and from port to port.

Its chambers have volumes that do not change; what the shaft lets through goes from one to the other. Angles are counted
as the arc at a radius r, so that places are in m and forces at that radius in N; with r = 1 m they are in rad and N m.

    flow through = D(x) x',   force = D(x) (p_l - p_u),   D(x) = D/r (1 + e cos(k x)),   k = z/r

z: waves per turn over 2 pi. Flow and torque have one ripple, so all of the oil's power is the shaft's. The oil that has
passed is the integral of D, a function of the place: stored oil is counted with it, S = V (1 + p/B) + integral in the
chamber that drives, minus it in the other, and none is lost.
"""

import math
from typing import NamedTuple

from twin.air import AnyAir, NoAir
from twin.kernel import inlined


class Motor(NamedTuple):
    """Displacement, volumes and leaks."""

    area_lower: float  # D/r, mean [m^2]
    area_upper: float  # the same
    dead_lower: float  # oil between line and shaft, port A [m^3]
    dead_upper: float  # port B
    stroke: float  # range of places that a scenario may ask for [m]
    leakage: float  # 1/R [m^3/(s Pa)], from port to port
    outside_lower: float  # 1/R [m^3/(s Pa)], into the case, which is drained to the tank
    outside_upper: float
    bulk_modulus: float  # B [Pa]
    vapour_pressure: float  # [Pa], gauge
    ripple: float  # e [-]
    waves: float  # k [1/m]
    air: AnyAir = NoAir()


@inlined
def displacement_at(position: float, motor: Motor) -> float:
    """D(x) [m^2]."""
    return motor.area_lower * (1.0 + motor.ripple * math.cos(motor.waves * position))


def displacement_slope(position: float, motor: Motor) -> float:
    """D'(x) [m]."""
    return -motor.area_lower * motor.ripple * motor.waves * math.sin(motor.waves * position)


@inlined
def passed_oil(position: float, motor: Motor) -> float:
    """Integral of D [m^3] from the place 0."""
    if motor.ripple == 0.0:
        return motor.area_lower * position
    return motor.area_lower * (position + motor.ripple / motor.waves * math.sin(motor.waves * position))
