"""How the two bodies of the relief valve move: a substep, its contacts, and how many substeps a step takes.

The poppet takes Numerov's rule, x1 - 2 x0 + x_1 = h^2 (a1 + 10 a0 + a_1)/12, so that its swing on spring and oil, whose
damping is the small difference of large terms, has the phase of the equations to order 4. As a rule of one step:
x1 = x0 + h u0 + h^2 (5 a0 + a1)/12, u1 = u0 + h (a0 + a1)/2; the lift is predicted with a0 for a1, and p2 corrects it.
The speed that sweeps oil, u1 - h (a1 - a0)/12, is right to order 3. The spool, which orifices damp with 1e5 to 1e7 1/s,
takes a backward rule in the backward differences of its speed, D v + D^2 v/2 + `THIRD` D^3 v + `FOURTH` D^4 v = h a1,
and x1 = x0 + h (5 v1 + 8 v0 - v_1)/12.
Symbols and signs: `README.md`, after (2.35), (2.41) of the thesis. Lifts >= 0 from the seats.
"""

import math
from typing import NamedTuple

from twin.contact import Stops, stopped, travel
from twin.kernel import inlined
from twin.relief.channel import absorbed_per_pressure, is_compressible
from twin.relief.network import (
    LEAST_OPENING,
    PoppetEnd,
    Relief,
    Solution,
    SpoolEnd,
    pilot_node,
    solve,
)
from twin.relief.poppet import pilot_opening, poppet_drag, spring_force
from twin.relief.seat import is_laminar, laminar_conductance, opening_slope, pressure_stiffness

FINEST = 6.25e-6  # [s], shortest substep
SHARE, LEAST = 0.2, 1e-6  # of its lift, and [m]: how far a substep may move the poppet
THIRD, FOURTH = 0.28, 0.15  # 0, 0: order 2; 1/3, 0: order 3; chosen for the damping of swings at 1.4 and 1.6 kHz
SWING = 1.7  # [rad], how far a substep may turn the poppet's own oscillation; the Verlet rule ends at 2


class ReliefState(NamedTuple):
    """What the valve remembers."""

    pilot_lift: float  # [m]
    pilot_velocity: float  # u [m/s], > 0 opens
    spool_lift: float  # [m]
    spool_velocity: float  # v [m/s], > 0 opens


class Motion(NamedTuple):
    """The valve within a step: its state and what the next substep starts with."""

    state: ReliefState
    y: float  # p2 as of `pilot_node`
    y_rate: float  # its change in the last substep, per time; 0.0 where its meaning changed
    pilot_force: float  # [N], 0.0 while a stop takes it
    spool_gain: float  # change of its speed in the last substep, per time [m/s^2]; 0.0 after a stop
    spool_gain_before: float  # the same, a substep earlier
    spool_gain_first: float  # two substeps earlier
    rise: float  # of the line's c in the last step [Pa]
    rise_before: float  # the same, a step earlier [Pa]
    pilot_oil: float  # stiffness of p2 against the poppet's lift, spool and inlet fixed [N/m]
    flow: float  # Q [m^3/s]
    filling: float  # into the oil before the pilot seat, C p2' [m^3/s]


@inlined
def unsupported(force: float, lift: float, velocity: float, stops: Stops) -> float:
    """What is left of a force [N] when a body at rest leans on a stop."""
    return stopped(lift, force, stops) if velocity == 0.0 else force


@inlined
def begin(s: ReliefState, p: float, flow: float, valve: Relief, rise: float = 0.0, rise_before: float = 0.0) -> Motion:
    """Forces of a state at an inlet pressure, in closed form, the pressure before the pilot seat at rest.

    rise, rise_before: of the line's c in the step before and in the one before that [Pa].
    """
    pilot, o = valve.pilot, valve.orifices
    conductance, area = pilot_opening(s.pilot_lift, pilot)
    pushed = valve.main.area * s.spool_velocity - pilot.area * s.pilot_velocity
    y = pilot_node(p, pushed, conductance, o, laminar_conductance(pilot.seat, s.pilot_lift))
    p2 = y * abs(y) if conductance > 0.0 else y
    force = area * p2 - spring_force(s.pilot_lift, pilot) - poppet_drag(s.pilot_lift, pilot) * s.pilot_velocity
    oil = oil_stiffness(y, s.pilot_lift, conductance, area, conductance * y - pushed, valve)
    force = unsupported(force, s.pilot_lift, s.pilot_velocity, pilot.stops)
    return Motion(s, y, 0.0, force, 0.0, 0.0, 0.0, rise, rise_before, oil, flow, 0.0)


@inlined
def oil_stiffness(y: float, lift: float, conductance: float, area: float, flow: float, valve: Relief) -> float:
    """How p2 resists the poppet's lift, spool and inlet fixed [N/m]: A dp2/dx, flow: through orifices 1 and 2."""
    stiff_12 = 2.0 * valve.orifices.a_12 * abs(flow) + valve.orifices.b_12
    return pressure_stiffness(valve.pilot.seat, stiff_12, y, lift, conductance, area)


@inlined
def move_spool(
    y: float, m: Motion, poppet: PoppetEnd, c: float, z: float, h: float, per_h: float, valve: Relief
) -> tuple[float, float, Solution]:
    """Lift of the spool, its gain of speed and the rest of the end of a substep, with its stops."""
    main, x, v = valve.main, m.state.spool_lift, m.state.spool_velocity
    gained, before, first = h * m.spool_gain, h * m.spool_gain_before, h * m.spool_gain_first
    weight, known = 1.5 + THIRD + FOURTH, (7.0 * v + gained) / 12.0
    inertia = weight * main.mass * per_h
    behind = (0.5 + 2.0 * THIRD + 3.0 * FOURTH) * gained - (THIRD + 3.0 * FOURTH) * before + FOURTH * first
    free = SpoolEnd(x + h * known, v + behind / weight, v + gained, inertia, 5.0 / 12.0 * h)
    resting = v == 0.0 and (x <= 0.0 or x >= main.stops.stroke)
    spool, stop = (SpoolEnd(x, 0.0, 0.0, inertia, 0.0) if resting else free), x
    while True:
        end = solve(y, poppet, spool, c, z, valve)
        if spool.lift_per_speed > 0.0:
            mean = known + 5.0 / 12.0 * end.spool_velocity
            then, rebound = travel(x, mean, main.stops, h)
            if rebound == mean:
                return then, (end.spool_velocity - v) * per_h, end
            stop, resting = (0.0 if mean < 0.0 else main.stops.stroke), False
            spool = SpoolEnd(then, rebound, rebound, inertia, 0.0)
        elif resting:
            if stopped(x, end.spool_force, main.stops) == 0.0:
                return x, 0.0, end
            spool = free
        elif spool.velocity != 0.0 and 2.0 * inertia * abs(spool.velocity) < abs(end.spool_force):
            spool = SpoolEnd(stop, 0.0, 0.0, inertia, 0.0)
        else:
            return spool.lift, 0.0, end


@inlined
def predict_lift(x: float, u: float, a: float, stops: Stops, h: float) -> tuple[float, float, float]:
    """Lift after a time h [s] under an acceleration a; the speed halfway through what follows an impact; that time.

    The impact is at its own instant. A rebound that would end within the substep, or slower than `rest_speed`, is none.
    """
    then = x + h * (u + 0.5 * h * a)
    stop = min(max(then, 0.0), stops.stroke)
    if then == stop:
        return then, u + 0.5 * h * a, h
    gap = abs(x - stop)
    sign = 1.0 if then > stop else -1.0
    u, a = sign * u, sign * a
    impact = math.sqrt(max(0.0, u * u + 2.0 * a * gap))
    left = h - ((impact - u) / a if u < 0.0 else 2.0 * gap / max(u + impact, 1e-300))
    rebound = stops.restitution * impact - 0.5 * left * a
    if impact <= stops.rest_speed or rebound <= 0.0:
        return stop, 0.0, left
    return stop - sign * left * rebound, -sign * rebound, left


@inlined
def substep(m: Motion, c: float, z: float, h: float, valve: Relief) -> Motion:
    """The valve a time h [s] later, c the line's value then. Impacts feel the forces of the start."""
    s, pilot, per_h = m.state, valve.pilot, 1.0 / h
    acceleration = m.pilot_force / pilot.mass
    lift, half_way, left = predict_lift(s.pilot_lift, s.pilot_velocity, acceleration, pilot.stops, h)
    conductance, area = pilot_opening(lift, pilot)
    drag, turbulent = poppet_drag(lift, pilot), not is_laminar(pilot.seat)
    before = m.y * abs(m.y) if turbulent and s.pilot_lift > 0.0 else m.y
    in_oil, laminar = absorbed_per_pressure(valve.channel, h), laminar_conductance(pilot.seat, lift)
    correcting, lagging, opening, stiffness = 0.0, 0.0, 0.0, pilot.stiffness
    if left == h and 0.0 < lift < pilot.stops.stroke:
        correcting, lagging = h * h / 12.0, -h / 12.0
        opening, area_slope = opening_slope(pilot.seat, lift, conductance, area)
        stiffness -= area_slope * (before if s.pilot_lift > 0.0 else 0.0)
    per_force = 1.0 / (pilot.mass + 0.5 * left * drag + stiffness * correcting)
    without_p2 = (stiffness * correcting * acceleration - spring_force(lift, pilot) - drag * half_way) * per_force
    per_p2 = area * per_force
    change = without_p2 - acceleration
    poppet = PoppetEnd(
        lift=lift,
        conductance=conductance,
        corrected=conductance + opening * correcting * change,
        corrected_per_p2=opening * correcting * per_p2,
        speed=half_way + 0.5 * left * without_p2,
        speed_per_p2=0.5 * left * per_p2,
        sweeping=half_way + 0.5 * left * without_p2 + lagging * change,
        sweeping_per_p2=(0.5 * left + lagging) * per_p2,
        outflow_per_p2=in_oil + laminar,
        inflow=in_oil * before + m.filling,
    )
    y, alike = m.y + h * m.y_rate, True
    if turbulent and s.pilot_lift <= 0.0 and lift > 0.0:
        y, alike = math.copysign(math.sqrt(abs(m.y)), m.y), False
    elif turbulent and s.pilot_lift > 0.0 and lift <= 0.0:
        y, alike = before, False
    spool_lift, spool_gain, end = move_spool(y, m, poppet, c, z, h, per_h, valve)
    p2 = end.y * abs(end.y) if turbulent and lift > 0.0 else end.y
    velocity = stopped(lift, poppet.speed + poppet.speed_per_p2 * p2, pilot.stops)
    correction = max(correcting * (change + per_p2 * p2), (LEAST_OPENING - 1.0) * lift)
    there = min(lift + correction, pilot.stops.stroke)
    force = area * p2 - spring_force(lift, pilot) - stiffness * correction - drag * velocity
    conductance += opening * correction
    through = conductance * end.y + pilot.area * velocity - valve.main.area * end.spool_velocity
    return Motion(
        ReliefState(there, velocity, spool_lift, end.spool_velocity),
        end.y,
        (end.y - m.y) * per_h if alike else 0.0,
        unsupported(force, there, velocity, pilot.stops),
        spool_gain,
        m.spool_gain,
        m.spool_gain_before,
        m.rise,
        m.rise_before,
        oil_stiffness(end.y, there, conductance, area, through, valve),
        end.flow,
        in_oil * (p2 - before) - m.filling if is_compressible(valve.channel) else 0.0,
    )


@inlined
def substeps(m: Motion, c_change: float, step: float, valve: Relief) -> int:
    """How many substeps a step takes: from the poppet's reach in it, and from its frequency on its spring and oil.

    The finest ones where oil or film of the pilot seat have a time of their own.
    """
    pilot = valve.pilot
    if is_compressible(valve.channel) or is_laminar(pilot.seat):
        return math.ceil(step / FINEST - 1e-9)
    push = (abs(m.pilot_force) + pilot.area * abs(c_change)) / pilot.mass
    reach = step * (abs(m.state.pilot_velocity) + 0.5 * step * push)
    allowed = SHARE * m.state.pilot_lift + LEAST
    turns = step * step * (pilot.stiffness + m.pilot_oil) / pilot.mass
    if reach <= allowed and turns <= SWING * SWING:
        return 1
    return math.ceil(min(max(reach / allowed, math.sqrt(turns) / SWING), step / FINEST))


@inlined
def with_rise(m: Motion, rise: float) -> Motion:
    """The same at the end of a step in which c rose by so much [Pa]."""
    return Motion(
        m.state,
        m.y,
        m.y_rate,
        m.pilot_force,
        m.spool_gain,
        m.spool_gain_before,
        m.spool_gain_first,
        rise,
        m.rise,
        m.pilot_oil,
        m.flow,
        m.filling,
    )
