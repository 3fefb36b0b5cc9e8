"""Gear pump: mean flow from the tooth geometry, less a leakage in proportion to pressure.

Source: (2.103), (2.104). Flow is counted at delivery pressure, as the rig's was (from the speed of the piston).
"""

import math
from typing import NamedTuple

from twin.kernel import kernel


class Pump(NamedTuple):
    """A pump at constant speed."""

    delivery: float  # at zero pressure [m^3/s]
    leakage: float  # [m^3/(s Pa)]


def displacement(width: float, module: float, teeth: float, pressure_angle: float) -> float:
    """Mean volume per revolution [m^3], (2.103); lengths in m, the pressure angle in rad."""
    gear = teeth + 1.0 - math.pi**2 / 12.0 * math.cos(pressure_angle) ** 2
    return 2.0 * math.pi * width * module**2 * gear


@kernel
def pump_flow(pressure: float, pump: Pump) -> float:
    """Delivered flow [m^3/s] at a delivery pressure [Pa]."""
    return pump.delivery - pump.leakage * pressure


@kernel
def pumped_oil(pressure: float, pump: Pump, bulk_modulus: float) -> tuple[float, float]:
    """The same as oil at reference density [m^3/s], (1 + p/B) Q(p), and its slope [m^3/(s Pa)]."""
    density_ratio = 1.0 + pressure / bulk_modulus
    flow = pump_flow(pressure, pump)
    return flow * density_ratio, flow / bulk_modulus - pump.leakage * density_ratio
