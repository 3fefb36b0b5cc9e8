"""Ideal pump of fixed displacement: Q = n V_g - k p at delivery pressure, without ripple.

Flow is counted as that of the gear pump: as oil at reference density it is (1 + p/B) Q. Displacement, speed and leakage
are entered as such. The pump gives energy; its leakage only takes.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined
from twin.oil import Oil
from twin.port import Port


class FixedPump(NamedTuple):
    """A pump at constant speed, once it has run up."""

    delivery: float  # n V_g, at full speed and no pressure [m^3/s]
    leakage: float  # k, to the tank [m^3/(s Pa)]
    run_up: float  # from standstill at time 0, at constant acceleration [s]; 0.0: it runs already


@inlined
def displaced_oil(pressure: float, volume: float, slope: float, oil: Oil) -> tuple[float, float]:
    """Oil at reference density [m^3/s] of a flow volume + slope p at delivery pressure, and its slope [m^3/(s Pa)]."""
    density_ratio, flow = 1.0 + pressure / oil.bulk_modulus, volume + slope * pressure
    return density_ratio * flow, flow / oil.bulk_modulus + slope * density_ratio


@inlined
def delivery_pressure(port: Port, volume: float, slope: float, oil: Oil) -> float:
    """p [Pa] where p = c + Z (1 + p/B) (volume + slope p), slope <= 0, and at least the vapour pressure.

    A quadratic in p with one root that goes with c. The other is a vacuum of the size of B/(Z slope).
    """
    z = port.impedance
    square = -z * slope / oil.bulk_modulus
    linear = 1.0 - z * (slope + volume / oil.bulk_modulus)
    rest = port.free + z * volume
    p = 2.0 * rest / (linear + math.sqrt(max(0.0, linear * linear + 4.0 * square * rest)))
    return max(oil.vapour_pressure, p)
