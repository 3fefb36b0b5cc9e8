"""The chamfered seat of the pilot poppet: a sharp edge whose loss law is fitted.

Symbols and signs: `README.md`, after (2.20), (2.25), (2.26), (2.33) of the thesis. The loss law is fitted to lifts of
0.01 to 0.1 seat diameters; at work the valve opens 0.001 to 0.0025, so results there extrapolate it.
"""

import math
from typing import NamedTuple

from twin.oil import Oil
from twin.relief.seat import is_laminar, laminar_conductance, opening_slope, pressure_stiffness, seat_damping, seat_flow
from twin.seats.frustum import frustum_area


class ChamferedSeat(NamedTuple):
    """Cone and edge."""

    diameter: float  # d_in [m]
    area: float  # A_in [m^2], pi/4 d_in^2
    sine: float  # sin alpha, alpha half the cone's angle
    cosine: float  # cos alpha
    conductance: float  # R/x^n [m^(3-n)/(s sqrt(Pa))]
    exponent: float  # n [-], half that of the loss law
    head: float  # rho/A_in^2 [kg/m^7]


def chamfered_seat(diameter: float, angle: float, loss_factor: float, loss_exponent: float, oil: Oil) -> ChamferedSeat:
    """The seat of these numbers; zeta = loss_factor (d_in/x)^loss_exponent, angle [rad] half the cone's."""
    area, exponent = math.pi / 4.0 * diameter**2, 0.5 * loss_exponent
    return ChamferedSeat(
        diameter=diameter,
        area=area,
        sine=math.sin(angle),
        cosine=math.cos(angle),
        conductance=area * math.sqrt(2.0 / (oil.density * loss_factor)) / diameter**exponent,
        exponent=exponent,
        head=oil.density / area**2,
    )


@seat_flow.register
def _(seat: ChamferedSeat, lift: float) -> tuple[float, float]:
    """(2.25), (2.26), and both fluid forces as one area.

    The momentum force rho Q^2 (1/A_in - cos a/A_pl), (2.33), is proportional to p2 by Q^2 = R^2 p2. So the area is
    A_in (1 + 2/zeta (1 - A_in cos a/A_pl)). In a reversed flow the sign of the force turns (assumed).
    """
    conductance = seat.conductance * lift**seat.exponent
    narrowing = seat.area * seat.cosine / frustum_area(lift, seat.diameter, seat.sine, seat.cosine)
    return conductance, seat.area * (1.0 + conductance**2 * seat.head * (1.0 - narrowing))


@opening_slope.register
def _(seat: ChamferedSeat, lift: float, conductance: float, area: float) -> tuple[float, float]:
    """By Q ~ x^n and A_pl ~ x, which holds at lifts much smaller than the seat."""
    per_lift, widest = 1.0 / lift, seat.area * conductance**2 * seat.head
    slope = seat.exponent * conductance * per_lift
    return slope, ((2.0 * seat.exponent - 1.0) * (area - seat.area) + widest) * per_lift


@laminar_conductance.register
def _(seat: ChamferedSeat, lift: float) -> float:
    return 0.0


@is_laminar.register
def _(seat: ChamferedSeat) -> bool:
    return False


@seat_damping.register
def _(seat: ChamferedSeat, lift: float, spring: float) -> float:
    return spring


@pressure_stiffness.register
def _(seat: ChamferedSeat, stiff_12: float, y: float, lift: float, conductance: float, area: float) -> float:
    yielding = 2.0 * abs(y) + stiff_12 * conductance
    return 2.0 * area * seat.exponent * stiff_12 * conductance * y * y / max(lift * yielding, 1e-30)
