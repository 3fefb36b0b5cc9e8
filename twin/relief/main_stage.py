"""Main stage of the relief valve: a spool with a chamfered seat, p below it, p3 above it, a soft spring.

Symbols and signs: `README.md`, after (2.19), (2.21), corrected (2.30), (2.31), (2.35), (2.37) of the
thesis. Lift x >= 0 from the seat, pressures gauge, tank at zero.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from twin.contact import Stops
from twin.kernel import inlined
from twin.oil import Oil
from twin.seats.frustum import frustum_area


class MainStage(NamedTuple):
    """Spool, spring and seat."""

    mass: float  # m [kg]
    stiffness: float  # s [N/m]
    preload: float  # s x0 [N]
    film: float  # K [N s/m], oil in the gap, (2.37)
    surge: float  # [N s/(m sqrt(Pa))]: times sqrt(p) the transient flow force, (2.31), which opposes motion
    diameter: float  # d [m]
    area: float  # A [m^2], pi/4 d^2
    sine: float  # sin alpha
    cosine: float  # cos alpha
    jet: float  # Cd sqrt(2/rho) [m/(s sqrt(Pa))]
    momentum: float  # 2 Cd^2/A [1/m^2]
    stops: Stops  # seat and upper stop


def main_stage(sizes: Mapping[str, Any], oil: Oil) -> MainStage:
    """The spool of a rig's numbers for its relief valve (SI)."""
    diameter, angle, discharge = sizes["spool_diameter"], sizes["spool_angle"], sizes["spool_discharge"]
    area, girth = math.pi / 4.0 * diameter**2, math.pi * diameter
    return MainStage(
        mass=sizes["spool_mass"],
        stiffness=sizes["spool_stiffness"],
        preload=sizes["spool_stiffness"] * sizes["spool_precompression"],
        film=girth * sizes["spool_length"] * oil.density * oil.viscosity / sizes["spool_gap"],
        surge=discharge * sizes["damping_length"] * girth * math.sin(angle) * math.sqrt(2.0 * oil.density),
        diameter=diameter,
        area=area,
        sine=math.sin(angle),
        cosine=math.cos(angle),
        jet=discharge * math.sqrt(2.0 / oil.density),
        momentum=2.0 * discharge**2 / area,
        stops=Stops(sizes["spool_travel"], sizes["spool_restitution"], sizes["rest_speed"]),
    )


class MainOpening(NamedTuple):
    """The main seat at a lift."""

    conductance: float  # k [m^3/(s sqrt(Pa))] of Q = k sqrt(p)
    area: float  # [m^2] on which p lifts the spool
    conductance_slope: float  # by the lift
    area_slope: float  # [m]


@inlined
def main_opening(lift: float, main: MainStage) -> MainOpening:
    """Flow and lifting area, A (1 + 2 Cd^2 a (a - cos th)) with a = A_out/A, and their slopes; shut below zero."""
    if lift <= 0.0:
        return MainOpening(0.0, main.area, 0.0, 0.0)
    opening = frustum_area(lift, main.diameter, main.sine, main.cosine)
    widening = math.pi * main.sine * (main.diameter - 2.0 * lift * main.sine * main.cosine)
    level = main.area * main.cosine
    return MainOpening(
        main.jet * opening,
        main.area + main.momentum * opening * (opening - level),
        main.jet * widening,
        main.momentum * (2.0 * opening - level) * widening,
    )


@inlined
def spool_spring(lift: float, main: MainStage) -> float:
    """Force of the spring towards the seat [N]."""
    return main.preload + main.stiffness * lift


@inlined
def spool_drag(root: float, main: MainStage) -> float:
    """K [N s/m] of film and transient flow force, root = sqrt(p) [sqrt(Pa)]."""
    return main.film + main.surge * root
