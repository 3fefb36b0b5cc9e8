"""The slot of the actuator: two chambers that push in opposite directions. Which kind is fitted is known when a step is
compiled.

`Cylinder`: twin/cylinder.py. `DrainedCylinder`: the same with leaks to the outside, and a barrel that gives way.
`Motor`: twin/motor.py. The lower chamber is that of port A; its pressure drives in the positive direction. Stored oil S
of a chamber, p = max(p_v, B ((S - passed)/V - 1)), is changed by what flows in alone, and by leaks.
"""

import math
from typing import Any

from twin.air import CLOSE, compression, pressure_at, rounds, tangent
from twin.cylinder import Chambers, Cylinder, DrainedCylinder, HoledCylinder
from twin.kernel import by_type, inlined
from twin.motor import Motor, displacement_at, passed_oil
from twin.port import Port

Actuator = Cylinder | DrainedCylinder | HoledCylinder | Motor


@by_type
def volumes(actuator: Any, position: float) -> Chambers:
    """Of the chambers [m^3]."""
    raise TypeError(f"{actuator} is not an actuator")


@volumes.register
def _(actuator: Cylinder | DrainedCylinder | HoledCylinder, position: float) -> Chambers:
    return Chambers(
        actuator.dead_lower + actuator.area_lower * position,
        actuator.dead_upper + actuator.area_upper * (actuator.stroke - position),
    )


@volumes.register
def _(actuator: Motor, position: float) -> Chambers:
    return Chambers(actuator.dead_lower, actuator.dead_upper)


@by_type
def passed(actuator: Any, position: float) -> Chambers:
    """Oil [m^3] that has left each chamber through the actuator, since the place 0."""
    raise TypeError(f"{actuator} is not an actuator")


@passed.register
def _(actuator: Cylinder | DrainedCylinder | HoledCylinder, position: float) -> Chambers:
    return Chambers(0.0, 0.0)


@passed.register
def _(actuator: Motor, position: float) -> Chambers:
    through = passed_oil(position, actuator)
    return Chambers(through, -through)


@by_type
def areas(actuator: Any, position: float) -> Chambers:
    """Force per pressure [m^2], which is flow per speed."""
    raise TypeError(f"{actuator} is not an actuator")


@areas.register
def _(actuator: Cylinder | DrainedCylinder | HoledCylinder, position: float) -> Chambers:
    return Chambers(actuator.area_lower, actuator.area_upper)


@areas.register
def _(actuator: Motor, position: float) -> Chambers:
    area = displacement_at(position, actuator)
    return Chambers(area, area)


@by_type
def moduli(actuator: Any) -> Chambers:
    """B [Pa] of what each chamber holds, with the walls around it."""
    raise TypeError(f"{actuator} is not an actuator")


@moduli.register
def _(actuator: Cylinder | Motor) -> Chambers:
    return Chambers(actuator.bulk_modulus, actuator.bulk_modulus)


@moduli.register
def _(actuator: DrainedCylinder | HoledCylinder) -> Chambers:
    return Chambers(actuator.modulus_lower, actuator.modulus_upper)


@by_type
def outside(actuator: Any, p: Chambers) -> Chambers:
    """Flow per pressure [m^3/(s Pa)] from each chamber to the outside or the case, at pressures [Pa]."""
    raise TypeError(f"{actuator} is not an actuator")


@outside.register
def _(actuator: Cylinder, p: Chambers) -> Chambers:
    return Chambers(0.0, 0.0)


@outside.register
def _(actuator: DrainedCylinder | Motor, p: Chambers) -> Chambers:
    return Chambers(actuator.outside_lower, actuator.outside_upper)


@outside.register
def _(actuator: HoledCylinder, p: Chambers) -> Chambers:
    return Chambers(
        actuator.outside_lower + _through_hole(p.lower, actuator.a_lower, actuator.b_lower),
        actuator.outside_upper + _through_hole(p.upper, actuator.a_upper, actuator.b_upper),
    )


@inlined
def _through_hole(p: float, a: float, b: float) -> float:
    """Q/p of a Q|Q| + b Q = p; nothing is drawn in."""
    return 2.0 / (b + math.sqrt(b * b + 4.0 * a * p)) if p > 0.0 else 0.0


@by_type
def widening(actuator: Any) -> float:
    """1.0 where oil fills the volume that the piston opens, at its pressure; 0.0 where it passes at no pressure's."""
    raise TypeError(f"{actuator} is not an actuator")


@widening.register
def _(actuator: Cylinder | DrainedCylinder | HoledCylinder) -> float:
    return actuator.by_mass


@widening.register
def _(actuator: Motor) -> float:
    return 0.0


@inlined
def chamber_volumes(position: float, actuator: Any) -> Chambers:
    """Lower and upper chamber [m^3]."""
    return volumes(actuator, position)


@inlined
def chamber_pressures(stored: Chambers, position: float, actuator: Any) -> Chambers:
    """p = max(p_v, B ((S - passed)/V - 1)) [Pa]."""
    volume, gone, b = volumes(actuator, position), passed(actuator, position), moduli(actuator)
    return Chambers(
        pressure_at(actuator.air, b.lower, (stored.lower - gone.lower) / volume.lower, actuator.vapour_pressure),
        pressure_at(actuator.air, b.upper, (stored.upper - gone.upper) / volume.upper, actuator.vapour_pressure),
    )


@inlined
def chamber_cavities(stored: Chambers, position: float, actuator: Any) -> Chambers:
    """Vapour in each chamber, as the oil [m^3 at reference density] that would fill it."""
    volume, gone, b = volumes(actuator, position), passed(actuator, position), moduli(actuator)
    thinnest_lower = compression(actuator.air, b.lower, actuator.vapour_pressure)
    thinnest_upper = compression(actuator.air, b.upper, actuator.vapour_pressure)
    return Chambers(
        max(0.0, volume.lower * thinnest_lower - (stored.lower - gone.lower)),
        max(0.0, volume.upper * thinnest_upper - (stored.upper - gone.upper)),
    )


@inlined
def stored_oil(pressures: Chambers, position: float, actuator: Any) -> Chambers:
    """The oil [m^3] that makes these pressures [Pa]."""
    volume, gone, b = volumes(actuator, position), passed(actuator, position), moduli(actuator)
    return Chambers(
        volume.lower * compression(actuator.air, b.lower, pressures.lower) + gone.lower,
        volume.upper * compression(actuator.air, b.upper, pressures.upper) + gone.upper,
    )


@by_type
def counted(actuator: Any, stored: Chambers, p: Chambers, before: float, then: float) -> Chambers:
    """Stored oil when the piston has gone from a position to another, as the actuator counts it.

    By volume, what is stored keeps its pressure p in the volume that opens: it grows by (S/V - 1) of that.
    """
    raise TypeError(f"{actuator} is not an actuator")


@counted.register
def _(
    actuator: Cylinder | DrainedCylinder | HoledCylinder, stored: Chambers, p: Chambers, before: float, then: float
) -> Chambers:
    if actuator.by_mass == 1.0:
        return stored
    old, new, b = volumes(actuator, before), volumes(actuator, then), moduli(actuator)
    dense_lower = compression(actuator.air, b.lower, p.lower) - 1.0
    dense_upper = compression(actuator.air, b.upper, p.upper) - 1.0
    return Chambers(
        stored.lower + dense_lower * (new.lower - old.lower), stored.upper + dense_upper * (new.upper - old.upper)
    )


@counted.register
def _(actuator: Motor, stored: Chambers, p: Chambers, before: float, then: float) -> Chambers:
    return stored


@inlined
def drive(p: Chambers, position: float, actuator: Any) -> float:
    """Force of the oil on the piston [N], (2.10)."""
    area = areas(actuator, position)
    return area.lower * p.lower - area.upper * p.upper


@inlined
def fill_chambers(
    stored: Chambers, p: Chambers, inflow: Chambers, lower: Port, upper: Port, position: float, actuator: Any,
    step: float,
) -> tuple[Chambers, Chambers, float]:  # fmt: skip
    """Stored oil and pressures a step [s] later, the piston then at a position [m], and oil lost to the outside [m^3].

    Trapezoidal rule. p, inflow: pressures and flows from the lines at the start. Ports of the lines at the end. Each
    chamber's C p + h/2 ((p - c)/Z + leaks) = S* - passed - V is linear, and has one answer with p >= p_v; with air it
    is a tangent, taken until it stands.
    """
    half, volume, gone = 0.5 * step, volumes(actuator, position), passed(actuator, position)
    leak, out = actuator.leakage * (p.lower - p.upper), outside(actuator, p)
    s_l = stored.lower + half * (inflow.lower - leak - out.lower * p.lower)
    s_u = stored.upper + half * (inflow.upper + leak - out.upper * p.upper)
    held = Chambers(s_l - gone.lower, s_u - gone.upper)
    p_l, p_u = p.lower, p.upper
    for _ in range(rounds(actuator.air)):
        before = p_l, p_u
        p_l, p_u = _by_tangents(Chambers(p_l, p_u), held, volume, lower, upper, actuator, out, half)
        if max(abs(p_l - before[0]), abs(p_u - before[1])) <= CLOSE:
            break
    leak = actuator.leakage * (p_l - p_u)
    then = Chambers(
        s_l + half * ((lower.free - p_l) / lower.impedance - leak - out.lower * p_l),
        s_u + half * ((upper.free - p_u) / upper.impedance + leak - out.upper * p_u),
    )
    return then, Chambers(p_l, p_u), half * (out.lower * (p.lower + p_l) + out.upper * (p.upper + p_u))


@inlined
def _by_tangents(
    p: Chambers, held: Chambers, volume: Chambers, lower: Port, upper: Port, actuator: Any, out: Chambers, half: float
) -> Chambers:
    """Both pressures that fill the chambers, what they hold linear about pressures p; out: flows out per pressure."""
    g, vapour, b = half * actuator.leakage, actuator.vapour_pressure, moduli(actuator)
    c_l, empty_l = tangent(actuator.air, b.lower, volume.lower, p.lower)
    c_u, empty_u = tangent(actuator.air, b.upper, volume.upper, p.upper)
    a_l = c_l + half / lower.impedance + g + half * out.lower
    a_u = c_u + half / upper.impedance + g + half * out.upper
    r_l = held.lower - empty_l + half * lower.free / lower.impedance
    r_u = held.upper - empty_u + half * upper.free / upper.impedance
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
