"""Short chamfered seat: turbulent flow over an edge, its loss coefficient, and the force on the cone.

Symbols and signs: `twin/README.md`, after (2.20), (2.25) to (2.27), (2.33), (2.34), (4.2) of the thesis. The lift
x >= 0 is axial, pressures gauge in Pa, forces in N, > 0 opens. The relief valve's own pilot:
`twin/relief/poppet.py`.
"""

import math
from typing import NamedTuple

from twin.seats.frustum import frustum_area


class ChamferedSeat(NamedTuple):
    """Edge, cone and oil."""

    diameter: float  # d_in [m], of the edge
    angle: float  # a [rad], half the angle of the cone
    discharge: float  # C_d [-], of (4.2)
    loss_factor: float  # of zeta = factor (d_in/x)^exponent, (2.26)
    loss_exponent: float
    density: float  # rho [kg/m^3]

    @property
    def area(self) -> float:
        """A_in [m^2]."""
        return math.pi / 4.0 * self.diameter**2


def opening(x: float, seat: ChamferedSeat) -> float:
    """Smallest area [m^2] between cone and edge, (2.20)."""
    return frustum_area(x, seat.diameter, math.sin(seat.angle), math.cos(seat.angle))


def discharge_flow(x: float, drop: float, seat: ChamferedSeat) -> float:
    """Q [m^3/s] with a constant C_d, (4.2); signed as the drop."""
    speed = math.copysign(math.sqrt(2.0 * abs(drop) / seat.density), drop)
    return seat.discharge * opening(x, seat) * speed


def loss_coefficient(x: float, seat: ChamferedSeat) -> float:
    """zeta [-] of drop = zeta rho/2 (Q/A_in)^2, (2.26)."""
    return seat.loss_factor * (seat.diameter / x) ** seat.loss_exponent


def idelchik_coefficient(x: float, seat: ChamferedSeat) -> float:
    """zeta [-] by Idelchik's measurements for 0.125 <= x/d_in <= 0.4, of an unstated angle, (2.27)."""
    return 0.6 + 0.15 * (seat.diameter / x) ** 2


def loss_flow(x: float, drop: float, seat: ChamferedSeat) -> float:
    """Q [m^3/s] by the loss coefficient, (2.25); signed as the drop."""
    speed = math.copysign(math.sqrt(2.0 * abs(drop) / (seat.density * loss_coefficient(x, seat))), drop)
    return seat.area * speed


def momentum_force(x: float, flow: float, seat: ChamferedSeat) -> float:
    """rho Q^2 (1/A_in - cos a/A_pl) [N], (2.33): at small lifts the jet pulls the cone shut."""
    return seat.density * flow**2 * (1.0 / seat.area - math.cos(seat.angle) / opening(x, seat))


def pressure_force(x: float, p_in: float, p_out: float, seat: ChamferedSeat) -> float:
    """A_in p_in - A_pl p_out cos a [N], (2.34): p_in all over the inlet, p_out over the opening."""
    return seat.area * p_in - opening(x, seat) * p_out * math.cos(seat.angle)
