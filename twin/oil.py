"""Hydraulic oil: viscosity, bulk modulus, and what an elastic wall makes of it.

Source: (2.3) to (2.9); the printed (2.9) used E = 2.1e10 Pa for steel, ten times too small.
"""

import math
from typing import NamedTuple

VISCOSITY_FLOOR, VISCOSITY_CEILING = -20.0, 80.0  # [deg C]; the quadratic law turns upwards at 108.1 deg C
SECONDS_TO_VISCOSITY = (8140.0 - 876.56) * 0.12837e-6  # (2.3): mu = t (rho_ball - rho) K [Pa s per s]


class Oil(NamedTuple):
    """What the kernels need of the oil."""

    density: float  # rho [kg/m^3], at reference (tank) pressure
    viscosity: float  # nu [m^2/s]
    bulk_modulus: float  # B_fluid [Pa]
    vapour_pressure: float  # [Pa], gauge


def kinematic_viscosity(temperature: float) -> float:
    """nu [m^2/s] at a temperature in deg C, the second-order law (2.6), (2.7).

    Raises ValueError below -20 and above 80 deg C, where the law leaves its data.
    """
    if not VISCOSITY_FLOOR <= temperature <= VISCOSITY_CEILING:
        raise ValueError(
            f"oil temperature {temperature} deg C: the viscosity law (2.6) holds from {VISCOSITY_FLOOR:g} to "
            f"{VISCOSITY_CEILING:g} deg C"
        )
    theta = temperature - 20.0
    return 117.95e-6 * math.exp(-0.0608 * theta + 3.45e-4 * theta**2)


def exponential_viscosity(temperature: float) -> float:
    """nu [m^2/s] at a temperature in deg C, the first-order law (2.5): coarser, off by 14 % at 25 deg C."""
    return 92.79e-6 * math.exp(-0.0401 * (temperature - 20.0))


def effective_modulus(bulk_modulus: float, diameter: float, wall: float, young: float) -> float:
    """B [Pa] of oil in a thin-walled elastic pipe, (2.8): 1/B = 1/B_fluid + d/(delta E)."""
    return 1.0 / (1.0 / bulk_modulus + diameter / (wall * young))


def fluid_modulus(effective: float, diameter: float, wall: float, young: float) -> float:
    """B_fluid [Pa] from the effective modulus measured in an elastic pipe: the inverse of (2.8)."""
    return 1.0 / (1.0 / effective - diameter / (wall * young))
