"""Mineral hydraulic oils by ISO viscosity grade: viscosity by temperature.

Walther's law as in ASTM D341, log10 log10(nu + 0.7) = A - B log10 T, nu in mm^2/s, T in K, through the viscosities at
40 and 100 deg C. A grade is named by that at 40 deg C (ISO 3448); that at 100 deg C belongs to a viscosity index of
100 by ASTM D2270, that of plain mineral oil (HL, HM). Densities are assumed: near those of makers' data sheets, 865 to
887 at 15 deg C, with 7e-4 of expansion per K up to 40 deg C; other temperatures leave them as they are.
"""

import math
from typing import NamedTuple


class Grade(NamedTuple):
    """An oil of viscosity index 100."""

    at_40: float  # nu at 40 deg C [mm^2/s]
    at_100: float  # nu at 100 deg C [mm^2/s]
    density: float  # rho at 40 deg C [kg/m^3]


GRADES = {
    "22": Grade(22.0, 4.294, 850.0),
    "32": Grade(32.0, 5.362, 857.0),
    "46": Grade(46.0, 6.761, 862.0),
    "68": Grade(68.0, 8.732, 867.0),
    "100": Grade(100.0, 11.382, 872.0),
}
ZERO = 273.15  # 0 deg C [K]
SHIFT = 0.7  # mm^2/s, of ASTM D341 for viscosities above 2 mm^2/s


def grade_viscosity(grade: str, temperature: float) -> float:
    """nu [m^2/s] of a grade at a temperature in deg C."""
    oil = GRADES[grade]
    cold, warm, at = (math.log10(t + ZERO) for t in (40.0, 100.0, temperature))
    high, low = (_double_log(nu) for nu in (oil.at_40, oil.at_100))
    return 1e-6 * (10.0**10.0 ** (high + (low - high) * (at - cold) / (warm - cold)) - SHIFT)


def _double_log(viscosity: float) -> float:
    return math.log10(math.log10(viscosity + SHIFT))
