"""Double-acting cylinder, vertical, rod down: two unequal chambers and a leak between them.

Source: (2.10) to (2.12). l is the lower (rod side, annulus, it lifts), u the upper chamber (cap side); x from the
lower end, upwards. A chamber keeps its stored oil S, at reference density, S = V (1 + p/B): what flows in is added to S
and never lost. When S is too small even at the vapour pressure, p stays there and the rest of the volume is vapour,
so this cavity needs no state of its own.
"""

from typing import NamedTuple

from twin.kernel import inlined
from twin.port import Port


class Cylinder(NamedTuple):
    """Areas, dead volumes and the leak."""

    area_lower: float  # A_l [m^2], annulus
    area_upper: float  # A_u [m^2], full bore
    dead_lower: float  # V_l [m^3]
    dead_upper: float  # V_u [m^3]
    stroke: float  # [m]
    leakage: float  # 1/R_h [m^3/(s Pa)], across the piston seal
    bulk_modulus: float  # B [Pa], of the oil in the chambers
    vapour_pressure: float  # [Pa], gauge


class Chambers(NamedTuple):
    """A value for each chamber."""

    lower: float
    upper: float


@inlined
def chamber_volumes(position: float, cylinder: Cylinder) -> Chambers:
    """Lower and upper chamber [m^3]."""
    return Chambers(
        cylinder.dead_lower + cylinder.area_lower * position,
        cylinder.dead_upper + cylinder.area_upper * (cylinder.stroke - position),
    )


@inlined
def chamber_pressures(stored: Chambers, position: float, cylinder: Cylinder) -> Chambers:
    """p = max(p_v, B (S/V - 1)) [Pa]."""
    volume, b = chamber_volumes(position, cylinder), cylinder.bulk_modulus
    return Chambers(
        max(cylinder.vapour_pressure, b * (stored.lower / volume.lower - 1.0)),
        max(cylinder.vapour_pressure, b * (stored.upper / volume.upper - 1.0)),
    )


@inlined
def chamber_cavities(stored: Chambers, position: float, cylinder: Cylinder) -> Chambers:
    """Vapour [m^3] in each chamber."""
    volume = chamber_volumes(position, cylinder)
    thinnest = 1.0 + cylinder.vapour_pressure / cylinder.bulk_modulus
    return Chambers(max(0.0, volume.lower * thinnest - stored.lower), max(0.0, volume.upper * thinnest - stored.upper))


def stored_oil(pressures: Chambers, position: float, cylinder: Cylinder) -> Chambers:
    """The oil [m^3] that makes these pressures [Pa]."""
    volume, b = chamber_volumes(position, cylinder), cylinder.bulk_modulus
    return Chambers(volume.lower * (1.0 + pressures.lower / b), volume.upper * (1.0 + pressures.upper / b))


@inlined
def drive(p: Chambers, cylinder: Cylinder) -> float:
    """Force of the oil on the piston [N], upwards, (2.10)."""
    return cylinder.area_lower * p.lower - cylinder.area_upper * p.upper


@inlined
def fill_chambers(
    stored: Chambers, p: Chambers, inflow: Chambers, lower: Port, upper: Port, position: float, cylinder: Cylinder,
    step: float,
) -> tuple[Chambers, Chambers]:  # fmt: skip
    """Stored oil and pressures a step [s] later, the piston then at a position [m]. Trapezoidal rule.

    p, inflow: pressures and flows from the lines at the start. Ports of the lines at the end. Each chamber's
    C p + h/2 ((p - c)/Z + leak) = S* - V is linear, and has one answer with p >= p_v.
    """
    half, vapour, volume = 0.5 * step, cylinder.vapour_pressure, chamber_volumes(position, cylinder)
    leak = cylinder.leakage * (p.lower - p.upper)
    g = half * cylinder.leakage
    a_l = volume.lower / cylinder.bulk_modulus + half / lower.impedance + g
    a_u = volume.upper / cylinder.bulk_modulus + half / upper.impedance + g
    s_l, s_u = stored.lower + half * (inflow.lower - leak), stored.upper + half * (inflow.upper + leak)
    r_l = s_l - volume.lower + half * lower.free / lower.impedance
    r_u = s_u - volume.upper + half * upper.free / upper.impedance
    determinant = a_l * a_u - g * g
    p_l, p_u = (a_u * r_l + g * r_u) / determinant, (a_l * r_u + g * r_l) / determinant
    if p_l < vapour or p_u < vapour:
        if p_u <= p_l:
            p_u = vapour
            p_l = max(vapour, (r_l + g * vapour) / a_l)
        else:
            p_l = vapour
            p_u = max(vapour, (r_u + g * vapour) / a_u)
    leak = cylinder.leakage * (p_l - p_u)
    then = Chambers(
        s_l + half * ((lower.free - p_l) / lower.impedance - leak),
        s_u + half * ((upper.free - p_u) / upper.impedance + leak),
    )
    return then, Chambers(p_l, p_u)
