"""Pilot poppet of the relief valve: a spring-loaded cone on its seat, p2 below it, the tank behind it.

Symbols and signs: `README.md`, after (2.32), (2.34), (2.41) to (2.44) of the thesis. Lift x >= 0 from the seat,
pressures gauge, tank at zero. What flows and pushes in the gap is the seat's: `seat`.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from twin.contact import Stops
from twin.kernel import inlined, kernel
from twin.oil import Oil
from twin.relief.chamfered_seat import ChamferedSeat, chamfered_seat
from twin.relief.long_seat import LongSeat, long_area
from twin.relief.seat import seat_damping, seat_flow


class Poppet(NamedTuple):
    """Cone, spring and seat."""

    mass: float  # m [kg], a third of the spring included, (2.42)
    stiffness: float  # s [N/m]
    preload: float  # s x0 [N], the spring's force on the seat
    drag: float  # K [N s/m], oil on the spring, (2.44)
    area: float  # A_in [m^2], pi/4 d_in^2
    stops: Stops  # seat and upper stop
    shut_area: float  # [m^2], on which p2 acts while shut
    seat: ChamferedSeat | LongSeat


def poppet(sizes: Mapping[str, Any], oil: Oil) -> Poppet:
    """The pilot of a rig's numbers for its relief valve (SI, `pilot_precompression` among them)."""
    diameter, angle = sizes["seat_diameter"], sizes["cone_angle"]
    area = math.pi / 4.0 * diameter**2
    if sizes["pilot_seat"] == "conical":
        viscosity, sine, cosine = oil.density * oil.viscosity, math.sin(angle), math.cos(angle)
        seat = LongSeat(0.5 * diameter, sizes["seat_length"], viscosity, sine, cosine, sizes["film_floor"])
        shut_area = long_area(0.0, seat)
    else:
        seat = chamfered_seat(diameter, angle, sizes["loss_factor"], sizes["loss_exponent"], oil)
        shut_area = area
    return Poppet(
        mass=sizes["pilot_mass"],
        stiffness=sizes["pilot_stiffness"],
        preload=sizes["pilot_stiffness"] * sizes["pilot_precompression"],
        drag=spring_drag(sizes["pilot_spring_diameter"], sizes["pilot_spring_turns"], oil),
        area=area,
        stops=Stops(sizes["pilot_travel"], sizes["pilot_restitution"], sizes["rest_speed"]),
        shut_area=shut_area,
        seat=seat,
    )


def spring_drag(diameter: float, turns: float, oil: Oil) -> float:
    """K [N s/m] of oil on a spring of a diameter [m], (2.44): 3/2 mu D pi n."""
    return 1.5 * oil.density * oil.viscosity * diameter * math.pi * turns


@inlined
def pilot_opening(lift: float, poppet: Poppet) -> tuple[float, float]:
    """R [m^3/(s sqrt(Pa))] of Q = R sqrt(p2), and the area [m^2] on which p2 acts, at a lift; R is 0.0 while shut."""
    if lift <= 0.0:
        return 0.0, poppet.shut_area
    return seat_flow(poppet.seat, lift)


@inlined
def spring_force(lift: float, poppet: Poppet) -> float:
    """Force of the spring towards the seat [N]."""
    return poppet.preload + poppet.stiffness * lift


@kernel
def cracking_pressure(poppet: Poppet) -> float:
    """p2 [Pa] up to which the spring holds the poppet on its seat."""
    return poppet.preload / poppet.shut_area


@inlined
def poppet_drag(lift: float, poppet: Poppet) -> float:
    """K [N s/m] of the oil on the spring and in the gap."""
    return seat_damping(poppet.seat, lift, poppet.drag)
