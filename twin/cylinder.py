"""Double-acting cylinder, vertical, rod down: two unequal chambers and a leak between them.

Source: (2.10) to (2.12). l is the lower (rod side, annulus, it lifts), u the upper chamber (cap side); x from the
lower end, upwards. A chamber keeps its stored oil S, at reference density, S = V (1 + p/B): what flows in is added to S
and never lost. When S is too small even at the vapour pressure, p stays there and the rest of the volume is vapour,
so this cavity needs no state of its own. With entrained air S/V follows the law of `twin/air.py`.
"""

from typing import NamedTuple

from twin.air import CLOSE, AnyAir, NoAir, compression, pressure_at, rounds, tangent
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
    air: AnyAir = NoAir()  # in the oil of the chambers


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
        pressure_at(cylinder.air, b, stored.lower / volume.lower, cylinder.vapour_pressure),
        pressure_at(cylinder.air, b, stored.upper / volume.upper, cylinder.vapour_pressure),
    )


@inlined
def chamber_cavities(stored: Chambers, position: float, cylinder: Cylinder) -> Chambers:
    """Vapour in each chamber, as the oil [m^3 at reference density] that would fill it."""
    volume = chamber_volumes(position, cylinder)
    thinnest = compression(cylinder.air, cylinder.bulk_modulus, cylinder.vapour_pressure)
    return Chambers(max(0.0, volume.lower * thinnest - stored.lower), max(0.0, volume.upper * thinnest - stored.upper))


def stored_oil(pressures: Chambers, position: float, cylinder: Cylinder) -> Chambers:
    """The oil [m^3] that makes these pressures [Pa]."""
    volume, b = chamber_volumes(position, cylinder), cylinder.bulk_modulus
    return Chambers(
        volume.lower * compression(cylinder.air, b, pressures.lower),
        volume.upper * compression(cylinder.air, b, pressures.upper),
    )


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
    C p + h/2 ((p - c)/Z + leak) = S* - V is linear, and has one answer with p >= p_v; with air it is a tangent, taken
    until it stands.
    """
    half, volume = 0.5 * step, chamber_volumes(position, cylinder)
    leak = cylinder.leakage * (p.lower - p.upper)
    s_l, s_u = stored.lower + half * (inflow.lower - leak), stored.upper + half * (inflow.upper + leak)
    p_l, p_u = p.lower, p.upper
    for _ in range(rounds(cylinder.air)):
        before = p_l, p_u
        p_l, p_u = _by_tangents(Chambers(p_l, p_u), Chambers(s_l, s_u), volume, lower, upper, cylinder, half)
        if max(abs(p_l - before[0]), abs(p_u - before[1])) <= CLOSE:
            break
    leak = cylinder.leakage * (p_l - p_u)
    then = Chambers(
        s_l + half * ((lower.free - p_l) / lower.impedance - leak),
        s_u + half * ((upper.free - p_u) / upper.impedance + leak),
    )
    return then, Chambers(p_l, p_u)


@inlined
def _by_tangents(
    p: Chambers, stored: Chambers, volume: Chambers, lower: Port, upper: Port, cylinder: Cylinder, half: float
) -> Chambers:
    """Both pressures that fill the chambers, what they hold linear about pressures p."""
    g, vapour, b = half * cylinder.leakage, cylinder.vapour_pressure, cylinder.bulk_modulus
    c_l, empty_l = tangent(cylinder.air, b, volume.lower, p.lower)
    c_u, empty_u = tangent(cylinder.air, b, volume.upper, p.upper)
    a_l, a_u = c_l + half / lower.impedance + g, c_u + half / upper.impedance + g
    r_l = stored.lower - empty_l + half * lower.free / lower.impedance
    r_u = stored.upper - empty_u + half * upper.free / upper.impedance
    determinant = a_l * a_u - g * g
    p_l, p_u = (a_u * r_l + g * r_u) / determinant, (a_l * r_u + g * r_l) / determinant
    if p_l < vapour or p_u < vapour:
        if p_u <= p_l:
            p_u = vapour
            p_l = max(vapour, (r_l + g * vapour) / a_l)
        else:
            p_l = vapour
            p_u = max(vapour, (r_u + g * vapour) / a_u)
    return Chambers(p_l, p_u)
