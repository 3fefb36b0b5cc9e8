"""Cushioned ends of a cylinder: near its stop the piston shuts the chamber's port, and oil leaves through a narrow way.

`orifice`: an edge, the cushioning screw, as soon as the piston is within the cushion's length. `spear`: the gap
between a spear and its bore, longer the deeper it dips, laminar, with the loss at its sharp entry:

    dp = 12 rho nu l/(pi d c^3) q + rho/(2 (Cd pi d c)^2) q^2,   l the depth, d the diameter, c the radial clearance

(gap of parallel plates, Merritt 1967; concentric: an eccentric spear leaks up to 2.5 times as much). Oil into the
chamber is free, through a check valve without a spring.
"""

import math
from typing import Any, NamedTuple

from twin.kernel import by_type
from twin.oil import Oil


class NoCushion(NamedTuple):
    """The ports stay open to the stops."""


class OrificeCushion(NamedTuple):
    """An edge at each end; a length of 0.0 for none."""

    lower_length: float  # [m]
    upper_length: float
    lower_a: float  # dp = a Q|Q| + b Q [Pa s^2/m^6]
    lower_b: float  # [Pa s/m^3]
    upper_a: float
    upper_b: float
    stroke: float  # [m]


class SpearCushion(NamedTuple):
    """A spear at each end; a length of 0.0 for none."""

    lower_spear: float  # length [m]
    upper_spear: float
    lower_entry: float  # a of the entry [Pa s^2/m^6]
    lower_gap: float  # b per depth [Pa s/m^4]
    upper_entry: float
    upper_gap: float
    stroke: float  # [m]


Cushion = NoCushion | OrificeCushion | SpearCushion


def spear_gap(diameter: float, clearance: float, discharge: float, oil: Oil) -> tuple[float, float]:
    """a of the entry [Pa s^2/m^6] and b per depth [Pa s/m^4] of a gap with a radial clearance [m]."""
    area = math.pi * diameter * clearance
    entry = oil.density / (2.0 * (discharge * area) ** 2)
    return entry, 12.0 * oil.density * oil.viscosity / (math.pi * diameter * clearance**3)


@by_type
def cushion_losses(cushion: Any, position: float) -> tuple[float, float, float, float]:
    """(a, b) of what leaves the lower chamber, then the upper one, the piston at a position [m]."""
    raise TypeError(f"{cushion} is not a cushion")


@cushion_losses.register
def _(cushion: NoCushion, position: float) -> tuple[float, float, float, float]:
    return 0.0, 0.0, 0.0, 0.0


@cushion_losses.register
def _(cushion: OrificeCushion, position: float) -> tuple[float, float, float, float]:
    lower = 1.0 if position < cushion.lower_length else 0.0
    upper = 1.0 if cushion.stroke - position < cushion.upper_length else 0.0
    return lower * cushion.lower_a, lower * cushion.lower_b, upper * cushion.upper_a, upper * cushion.upper_b


@cushion_losses.register
def _(cushion: SpearCushion, position: float) -> tuple[float, float, float, float]:
    lower, upper = cushion.lower_spear - position, cushion.upper_spear - (cushion.stroke - position)
    return (
        cushion.lower_entry if lower > 0.0 else 0.0,
        cushion.lower_gap * max(0.0, lower),
        cushion.upper_entry if upper > 0.0 else 0.0,
        cushion.upper_gap * max(0.0, upper),
    )
