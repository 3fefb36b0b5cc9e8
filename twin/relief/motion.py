"""How the two bodies of the relief valve move: a substep, its contacts, and how many substeps a step takes.

The poppet takes the velocity Verlet rule: order 2, its lift explicit, its speed implicit in p2. The spool's speed is
taken wholly at the end of the substep, since orifices damp it with 1e5 to 1e7 1/s; its lift by the trapezoidal rule.
Symbols and signs: `README.md`, after (2.35), (2.41) of the thesis. Lifts >= 0 from the seats.
"""

import math
from typing import NamedTuple

from twin.contact import Stops, stopped, travel
from twin.kernel import inlined
from twin.relief.channel import absorbed_per_pressure, is_compressible
from twin.relief.network import (
    End,
    Poise,
    Push,
    Relief,
    meet,
    pilot_node,
)
from twin.relief.poppet import pilot_opening, poppet_drag, spring_force
from twin.relief.seat import is_laminar, laminar_conductance, pressure_stiffness

FINEST = 6.25e-6  # [s], shortest substep
SHARE, LEAST = 0.2, 1e-6  # of its lift, and [m]: how far a substep may move the poppet
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
    pilot_force: float  # [N], 0.0 while a stop takes it
    pilot_oil: float  # stiffness of p2 against the poppet's lift, spool and inlet fixed [N/m]
    flow: float  # Q [m^3/s]
    filling: float  # into the oil before the pilot seat, C p2' [m^3/s]


@inlined
def borne(force: float, lift: float, velocity: float, stops: Stops) -> float:
    """What is left of a force when a body at rest leans on a stop."""
    return stopped(lift, force, stops) if velocity == 0.0 else force


@inlined
def begin(s: ReliefState, p: float, flow: float, valve: Relief) -> Motion:
    """Forces of a state at an inlet pressure, in closed form, the pressure before the pilot seat at rest."""
    pilot, o = valve.pilot, valve.orifices
    conductance, area = pilot_opening(s.pilot_lift, pilot)
    pushed = valve.main.area * s.spool_velocity - pilot.area * s.pilot_velocity
    y = pilot_node(p, pushed, conductance, o, laminar_conductance(pilot.seat, s.pilot_lift))
    p2 = y * abs(y) if conductance > 0.0 else y
    force = area * p2 - spring_force(s.pilot_lift, pilot) - poppet_drag(s.pilot_lift, pilot) * s.pilot_velocity
    oil = oil_stiffness(y, s.pilot_lift, conductance, area, conductance * y - pushed, valve)
    return Motion(s, y, borne(force, s.pilot_lift, s.pilot_velocity, pilot.stops), oil, flow, 0.0)


@inlined
def oil_stiffness(y: float, lift: float, conductance: float, area: float, flow: float, valve: Relief) -> float:
    """How p2 resists the poppet's lift, spool and inlet fixed [N/m]: A dp2/dx, flow: through orifices 1 and 2."""
    stiff_12 = 2.0 * valve.orifices.a_12 * abs(flow) + valve.orifices.b_12
    return pressure_stiffness(valve.pilot.seat, stiff_12, y, lift, conductance, area)


@inlined
def move_spool(y: float, m: Motion, poise: Poise, c: float, z: float, h: float, valve: Relief) -> tuple[float, End]:
    """Lift of the spool and the rest of the end of a substep, with its stops."""
    main, x, v = valve.main, m.state.spool_lift, m.state.spool_velocity
    inertia = main.mass / h
    free = Push(x, v, inertia, 0.5 * h)
    resting = v == 0.0 and (x <= 0.0 or x >= main.stops.stroke)
    push, stop = (Push(x, 0.0, inertia, 0.0) if resting else free), x
    while True:
        end = meet(y, push.velocity, poise, push, c, z, valve)
        if push.half > 0.0:
            mean = 0.5 * (v + end.spool_velocity)
            then, rebound = travel(x, mean, main.stops, h)
            if rebound == mean:
                return then, end
            stop, resting = (0.0 if mean < 0.0 else main.stops.stroke), False
            push = Push(then, rebound, inertia, 0.0)
        elif resting:
            if stopped(x, end.spool_force, main.stops) == 0.0:
                return x, end
            push = free
        elif push.velocity != 0.0 and 2.0 * inertia * abs(push.velocity) < abs(end.spool_force):
            push = Push(stop, 0.0, inertia, 0.0)
        else:
            return push.lift, end


@inlined
def fly(x: float, u: float, a: float, stops: Stops, h: float) -> tuple[float, float, float]:
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
    hit = math.sqrt(max(0.0, u * u + 2.0 * a * gap))
    left = h - ((hit - u) / a if u < 0.0 else 2.0 * gap / max(u + hit, 1e-300))
    away = stops.restitution * hit - 0.5 * left * a
    if hit <= stops.rest_speed or away <= 0.0:
        return stop, 0.0, left
    return stop - sign * left * away, -sign * away, left


@inlined
def substep(m: Motion, c: float, z: float, h: float, valve: Relief) -> Motion:
    """The valve a time h [s] later, c the line's value then. Impacts feel the forces of the start."""
    s, pilot = m.state, valve.pilot
    lift, half_way, left = fly(s.pilot_lift, s.pilot_velocity, m.pilot_force / pilot.mass, pilot.stops, h)
    conductance, area = pilot_opening(lift, pilot)
    drag = poppet_drag(lift, pilot)
    gain = 0.5 * left / (pilot.mass + 0.5 * left * drag)
    coasting = half_way - gain * (spring_force(lift, pilot) + drag * half_way)
    turbulent = not is_laminar(pilot.seat)
    before = m.y * abs(m.y) if turbulent and s.pilot_lift > 0.0 else m.y
    stiff, laminar = absorbed_per_pressure(valve.channel, h), laminar_conductance(pilot.seat, lift)
    poise = Poise(lift, conductance, coasting, gain * area, stiff + laminar, stiff * before + m.filling)
    y = m.y
    if turbulent and s.pilot_lift <= 0.0 and lift > 0.0:
        y = math.copysign(math.sqrt(abs(y)), y)
    elif turbulent and s.pilot_lift > 0.0 and lift <= 0.0:
        y = y * abs(y)
    x, end = move_spool(y, m, poise, c, z, h, valve)
    p2 = end.y * abs(end.y) if turbulent and lift > 0.0 else end.y
    force = area * p2 - spring_force(lift, pilot) - drag * end.pilot_velocity
    through = conductance * end.y + pilot.area * end.pilot_velocity - valve.main.area * end.spool_velocity
    return Motion(
        ReliefState(lift, end.pilot_velocity, x, end.spool_velocity),
        end.y,
        borne(force, lift, end.pilot_velocity, pilot.stops),
        oil_stiffness(end.y, lift, conductance, area, through, valve),
        end.flow,
        stiff * (p2 - before) - m.filling if is_compressible(valve.channel) else 0.0,
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
