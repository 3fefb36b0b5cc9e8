"""Double-acting cylinder: two chambers, a leak between them, and what leaks and gives way besides.

Source: (2.10) to (2.12). l is the lower chamber (of port A; in the thesis the rod side, annulus, it lifts), u the upper
chamber (of port B); x from the lower end, in the direction in which the lower chamber pushes. A chamber keeps its
stored oil S, at reference density, S = V (1 + p/B): what flows in is added to S and never lost. When S is too small
even at the vapour pressure, p stays there and the rest of the volume is vapour, so this cavity needs no state of its
own. With entrained air S/V follows the law of `twin/air.py`. What chambers of any actuator do: `twin/actuator.py`.

Counted by volume, as (2.11) and (2.12) are printed and most simulators have it, a flow is taken at the pressure of its
chamber, dp/dt = B/V (Q - A v): for the same flow a piston moves faster, by p/B. Oil is then not conserved.
"""

from typing import NamedTuple

from twin.air import AnyAir, NoAir


class Cylinder(NamedTuple):
    """Areas, dead volumes and the leak."""

    area_lower: float  # A_l [m^2]
    area_upper: float  # A_u [m^2]
    dead_lower: float  # V_l [m^3]
    dead_upper: float  # V_u [m^3]
    stroke: float  # [m]
    leakage: float  # 1/R_h [m^3/(s Pa)], across the piston seal
    bulk_modulus: float  # B [Pa], of the oil in the chambers
    vapour_pressure: float  # [Pa], gauge
    air: AnyAir = NoAir()  # in the oil of the chambers
    by_mass: float = 1.0  # 1.0: oil is counted by mass; 0.0: by volume


class DrainedCylinder(NamedTuple):
    """The same with leaks to the outside, at the tank's pressure, and a barrel that gives way."""

    area_lower: float  # [m^2]
    area_upper: float
    dead_lower: float  # [m^3]
    dead_upper: float
    stroke: float  # [m]
    leakage: float  # 1/R [m^3/(s Pa)], across the piston seal
    outside_lower: float  # 1/R [m^3/(s Pa)], from the chamber to the outside
    outside_upper: float
    modulus_lower: float  # B [Pa], of oil and barrel
    modulus_upper: float
    vapour_pressure: float  # [Pa], gauge
    air: AnyAir = NoAir()
    by_mass: float = 1.0


class HoledCylinder(NamedTuple):
    """The same with a hole to the outside in each chamber, or at its end of the line: a Q|Q| + b Q = p.

    It passes what the pressure at the beginning of a step asks for, in proportion to the pressure within the step. No
    air is drawn in.
    """

    area_lower: float  # [m^2]
    area_upper: float
    dead_lower: float  # [m^3]
    dead_upper: float
    stroke: float  # [m]
    leakage: float  # 1/R [m^3/(s Pa)], across the piston seal
    outside_lower: float  # 1/R [m^3/(s Pa)], from the chamber to the outside
    outside_upper: float
    modulus_lower: float  # B [Pa], of oil and barrel
    modulus_upper: float
    vapour_pressure: float  # [Pa], gauge
    a_lower: float  # [Pa s^2/m^6], of the holes
    a_upper: float
    b_lower: float  # [Pa s/m^3]; infinite where there is no hole
    b_upper: float
    air: AnyAir = NoAir()
    by_mass: float = 1.0


class Chambers(NamedTuple):
    """A value for each chamber."""

    lower: float
    upper: float
