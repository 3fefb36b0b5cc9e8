"""What a line is, and the numbers that every model makes its own from."""

import math
from typing import NamedTuple

MODELS = ("lumped", "ends", "nodes", "volume")
LOSSES = {"none": "none", "steady": "steady", "quasi-steady": "steady", "unsteady": "unsteady"}  # N(s) of a friction
TURBULENT = ("quasi-steady", "unsteady")  # frictions that know Re


class Creep(NamedTuple):
    """A Kelvin-Voigt element of the wall: a share of compliance that follows the pressure late."""

    share: float  # w, over the compliance that oil and wall have at once
    time: float  # tau, of retardation [s]


class LineSpec(NamedTuple):
    """A pipe or hose."""

    length: float  # [m]
    diameter: float  # inner [m]
    modulus: float  # effective bulk modulus, with the wall [Pa]
    density: float  # [kg/m^3]
    viscosity: float  # nu [m^2/s]
    model: str  # of MODELS
    friction: str  # of LOSSES
    creep: tuple[Creep, ...] = ()  # elements of the wall, at most `wall.ELEMENTS`


class LineNumbers(NamedTuple):
    """The same, derived."""

    z0: float  # rho a/A [Pa s/m^3]
    capacity: float  # C = V/B, at once [m^3/Pa]
    settled_capacity: float  # after all creep, C (1 + sum w) [m^3/Pa]
    inertance: float  # rho l/A [Pa s^2/m^3]
    resistance: float  # laminar, 128 mu l/(pi d^4); 0 without friction [Pa s/m^3]
    travel_time: float  # T = l/a [s]
    viscous_time: float  # t_v = R^2/nu [s]
    turbulent_per_flow: float  # Re per flow, 4/(pi d nu); 0 if the friction does not know Re [s/m^3]
    losses: str  # of theory.LOSSES
    creep: tuple[Creep, ...]


def derive(s: LineSpec) -> LineNumbers:
    area, speed = math.pi / 4.0 * s.diameter**2, math.sqrt(s.modulus / s.density)
    laminar = 128.0 * s.density * s.viscosity * s.length / (math.pi * s.diameter**4)
    capacity = area * s.length / s.modulus
    return LineNumbers(
        z0=s.density * speed / area,
        capacity=capacity,
        settled_capacity=capacity * (1.0 + sum(element.share for element in s.creep)),
        inertance=s.density * s.length / area,
        resistance=0.0 if s.friction == "none" else laminar,
        travel_time=s.length / speed,
        viscous_time=s.diameter**2 / (4.0 * s.viscosity),
        turbulent_per_flow=4.0 / (math.pi * s.diameter * s.viscosity) if s.friction in TURBULENT else 0.0,
        losses=LOSSES[s.friction],
        creep=s.creep,
    )
