"""The drive reduced to what decides how a loop swings: load, two chambers, valve, and oil that must be set in motion.

Kept are the seal's friction, the root in the valve's flow, its lands, the spool's lag, rate and travel, the leak, the
inertia, the capacity and, at one frequency, the resistance of the lines, the pump, and the relief valve as a straight
line. Left out are waves, friction in the lines by frequency, the relief valve's own motion, and the ripple of the
pump. So a step may be half a millisecond long, ten times the plant's. A pressure below the vapour pressure stands for
a cavity.
"""

import cmath
from typing import Any, NamedTuple

import numpy as np

from twin.actuator import Actuator, chamber_pressures, drive, outside
from twin.contact import AnyStops, NoStops, Stops
from twin.cylinder import Chambers
from twin.directional_valve import land_orifice, lands_at
from twin.fitting import Fitting, fitting_resistance
from twin.friction import NoFriction, slide
from twin.kernel import by_type, inlined
from twin.lands import Lands, Ports, land_flows
from twin.lever import Lever
from twin.load import Load, Weight
from twin.load_slot import HeldLoad, Push, move_load, push_of
from twin.oil import Oil
from twin.port import Port
from twin.seal import Seal
from twin.spool_valve import SpoolValve, move_spool
from twin.stribeck import Stribeck
from twin.switching_valve import SwitchingValve, switch_spool

PARTS = 5  # of a step, for the piston
NO_WEIGHT, ENDLESS, NOTHING = Weight(0.0, 0.0, 0.0), NoStops(0.0), np.zeros(1)


class Line(NamedTuple):
    """A line as one lump of oil between two springs."""

    inertance: float  # [Pa s^2/m^3]
    resistance: float  # [Pa s/m^3]
    quadratic: float  # of elbows and tees [Pa s^2/m^6]


class Supply(NamedTuple):
    """Pump and relief valve, both straight lines."""

    delivery: float  # at no pressure [m^3/s]
    leakage: float  # of the pump [m^3/(s Pa)]
    opening: float  # pressure at which the relief valve opens [Pa]
    slope: float  # of its flow from there on [m^3/(s Pa)]


class Capacities(NamedTuple):
    """Oil per pressure [m^3/Pa] where lines meet."""

    tee: float
    p: float
    a: float
    b: float
    t: float
    back: float


class Drive(NamedTuple):
    """All numbers that a step reads."""

    load: Load | HeldLoad | Lever  # without a weight that joins
    stops: AnyStops
    oil: Oil
    cylinder: Actuator  # its dead volumes include half of the hoses
    seal: Seal | Stribeck | NoFriction
    valve: SpoolValve | SwitchingValve
    supply: Supply
    fitting: Fitting  # in line 2
    capacities: Capacities
    line_2: Line
    line_3: Line
    line_4: Line
    line_5: Line
    line_6: Line


class Pace(NamedTuple):
    """A length of step, and what the spool does in it: rows of its exact matrix."""

    step: float  # [s]
    position_from_position: float
    position_from_speed: float
    speed_from_position: float
    speed_from_speed: float


class Into(NamedTuple):
    """Flow that the lands bring to each port [m^3/s]."""

    p: float
    a: float
    b: float
    t: float


class DriveState(NamedTuple):
    """Everything with a memory. Speeds and flows of the lines stand half a step before the rest."""

    position: float  # [m]
    velocity: float  # [m/s]
    spool: float  # -1..1
    spool_speed: float  # [1/s]
    stored: Chambers  # [m^3]
    p_tee: float  # [Pa]
    p_p: float
    p_a: float
    p_b: float
    p_t: float
    p_back: float
    into: Into
    q_2: float  # [m^3/s], away from the pump, towards the cylinder, towards the tank
    q_3: float
    q_4: float
    q_5: float
    q_6: float


@inlined
def advance(s: DriveState, reference: float, d: Drive, pace: Pace) -> DriveState:
    """A step later, under a spool reference -1..1."""
    h, vapour, c = pace.step, d.oil.vapour_pressure, d.capacities
    p = chamber_pressures(s.stored, s.position, d.cylinder)
    spool, spool_speed, areas = _lands(s, reference, d, pace)
    strainer, p_p, p_back = fitting_resistance(s.q_2, d.fitting), max(vapour, s.p_p), max(vapour, s.p_back)
    q_2 = _moved(s.q_2, max(vapour, s.p_tee) - p_p, d.line_2, strainer, h)
    q_3 = _moved(s.q_3, max(vapour, s.p_a) - p.lower, d.line_3, 0.0, h)
    q_4 = _moved(s.q_4, max(vapour, s.p_b) - p.upper, d.line_4, 0.0, h)
    q_5 = _moved(s.q_5, max(vapour, s.p_t) - p_back, d.line_5, 0.0, h)
    q_6 = _moved(s.q_6, p_back, d.line_6, 0.0, h)
    ports = Ports(
        _port(s.p_p, q_2, s.into.p, c.p, h),
        _port(s.p_a, -q_3, s.into.a, c.a, h),
        _port(s.p_b, -q_4, s.into.b, c.b, h),
        _port(s.p_t, -q_5, s.into.t, c.t, h),
    )
    q = land_flows(ports, areas, land_orifice(d.valve), d.oil)
    into = Into(-(q.p_a + q.p_b + q.p_t), q.p_a - q.a_t, q.p_b - q.b_t, q.b_t + q.a_t + q.p_t)
    position, velocity, stored = _glide(s.position, s.velocity, s.stored, q_3, q_4, h, d)
    return DriveState(
        position,
        velocity,
        spool,
        spool_speed,
        stored,
        _tee(s.p_tee, q_2, d, h),
        ports.p.free + ports.p.impedance * into.p,
        ports.a.free + ports.a.impedance * into.a,
        ports.b.free + ports.b.impedance * into.b,
        ports.t.free + ports.t.impedance * into.t,
        s.p_back + h / c.back * (q_5 - q_6),
        into,
        q_2,
        q_3,
        q_4,
        q_5,
        q_6,
    )


@inlined
def _glide(
    x: float, v: float, stored: Chambers, q_3: float, q_4: float, step: float, d: Drive
) -> tuple[float, float, Chambers]:
    """Position, velocity and chambers a step later. Sticking and breaking loose need PARTS shorter steps."""
    h = step / PARTS
    for _ in range(PARTS):
        p = chamber_pressures(stored, x, d.cylinder)
        push = _push(d.load, drive(p, x, d.cylinder), x, v, h)
        v = slide(d.seal, v, push.force, push.mass, abs(p.lower - p.upper), NOTHING, h)
        x, v = _travel(d.load, x, v, h)
        x, v = _within(d.stops, x, v)
        leak, out = d.cylinder.leakage * (p.lower - p.upper), outside(d.cylinder, p)
        stored = Chambers(
            stored.lower + h * (q_3 - leak - out.lower * p.lower), stored.upper + h * (q_4 + leak - out.upper * p.upper)
        )
    return x, v, stored


@by_type
def _push(load: Any, oil: float, x: float, v: float, time: float) -> Push:
    """What moves, and all forces on it but the friction."""
    raise TypeError(f"{load} is not a load of a reduced drive")


@_push.register
def _(load: Load, oil: float, x: float, v: float, time: float) -> Push:
    return Push(load.mass, oil - (load.mass * load.gravity - load.force), 0.0)


@_push.register
def _(load: HeldLoad | Lever, oil: float, x: float, v: float, time: float) -> Push:
    return push_of(load, oil, x, v, NO_WEIGHT, NOTHING, time)


@by_type
def _travel(load: Any, x: float, v: float, time: float) -> tuple[float, float]:
    """Position and velocity after a time without a force."""
    raise TypeError(f"{load} is not a load of a reduced drive")


@_travel.register
def _(load: Load | HeldLoad, x: float, v: float, time: float) -> tuple[float, float]:
    return x + time * v, v


@_travel.register
def _(load: Lever, x: float, v: float, time: float) -> tuple[float, float]:
    x, v, _ = move_load(load, x, v, NO_WEIGHT, ENDLESS, NOTHING, time)
    return x, v


@by_type
def _within(stops: Any, x: float, v: float) -> tuple[float, float]:
    """Position and velocity between the stops."""
    raise TypeError(f"{stops} are not stops")


@_within.register
def _(stops: Stops, x: float, v: float) -> tuple[float, float]:
    if x <= 0.0 or x >= stops.stroke:
        return min(max(x, 0.0), stops.stroke), 0.0
    return x, v


@_within.register
def _(stops: NoStops, x: float, v: float) -> tuple[float, float]:
    return x, v


@inlined
def _port(before: float, line: float, lands: float, capacity: float, step: float) -> Port:
    """A line's end at the valve: trapezoidal in what the lands bring, `lands` at the step's start."""
    return Port(before + step / capacity * (line + 0.5 * lands), 0.5 * step / capacity)


@inlined
def _lands(s: DriveState, reference: float, d: Drive, pace: Pace) -> tuple[float, float, Lands]:
    """Spool and speed a step later, and the areas it opens."""
    spool, speed = _move(d.valve, s.spool, s.spool_speed, reference, pace)
    return spool, speed, lands_at(d.valve, spool)


@by_type
def _move(valve: Any, spool: float, speed: float, reference: float, pace: Pace) -> tuple[float, float]:
    """Spool and speed a step later."""
    raise TypeError(f"{valve} is not a directional valve")


@_move.register
def _(valve: SwitchingValve, spool: float, speed: float, reference: float, pace: Pace) -> tuple[float, float]:
    return switch_spool(spool, reference, valve, pace.step)


@_move.register
def _(valve: SpoolValve, spool: float, speed: float, reference: float, pace: Pace) -> tuple[float, float]:
    v = valve
    matrix = pace.position_from_position, pace.position_from_speed, pace.speed_from_position, pace.speed_from_speed
    paced = SpoolValve(v.natural_frequency, v.damping, v.rate, v.overlap, v.area, v.orifice, *matrix)
    return move_spool(spool, speed, reference, paced, pace.step)


@inlined
def _moved(flow: float, drop: float, line: Line, more: float, step: float) -> float:
    """Flow of a line a step later; the resistance acts at its end."""
    against = line.resistance + line.quadratic * abs(flow) + more
    return (flow + step / line.inertance * drop) / (1.0 + step / line.inertance * against)


@inlined
def _tee(before: float, out: float, d: Drive, step: float) -> float:
    """Pressure between pump and relief valve a step later, implicit."""
    per, s = step / d.capacities.tee, d.supply
    p = (before + per * (s.delivery - out)) / (1.0 + per * s.leakage)
    if p <= s.opening:
        return p
    return (before + per * (s.delivery - out + s.slope * s.opening)) / (1.0 + per * (s.leakage + s.slope))


def pace_of(valve: SpoolValve | SwitchingValve, step: float) -> Pace:
    """The pace of a step [s]: expm(step [[0, 1], [-omega^2, -2 zeta omega]]); a switching spool needs no matrix."""
    if not isinstance(valve, SpoolValve):
        return Pace(step, 0.0, 0.0, 0.0, 0.0)
    omega, zeta = valve.natural_frequency, valve.damping
    root = cmath.sqrt(zeta * zeta - 1.0 + (1e-12 if abs(zeta - 1.0) < 1e-12 else 0.0))
    s_1, s_2 = omega * (root - zeta), omega * (-root - zeta)
    e_1, e_2 = cmath.exp(s_1 * step), cmath.exp(s_2 * step)
    from_speed = (e_1 - e_2) / (s_1 - s_2)
    return Pace(
        step,
        ((s_1 * e_2 - s_2 * e_1) / (s_1 - s_2)).real,
        from_speed.real,
        (-(omega**2) * from_speed).real,
        ((s_1 * e_1 - s_2 * e_2) / (s_1 - s_2)).real,
    )
