"""Servo valve: four independent lands, any of which may be open together, and a leak through the clearance of each.

Land i opens in its direction x = +-(s - null bias) from its overlap l on, a share of the travel; below 0 it is an
underlap, and the land is open at null. Beyond it the area is a share of the land's own, by a straight line or a table
over y = (x - l)/(1 - l). Sources: H. E. Merritt, Hydraulic Control Systems (1967):

    sharp edge                  orifice.py, for any opening; with transition 0 purely turbulent, 3-37
    leak of a land at its edge  g_0 = pi w c^2/(32 mu), so that a valve without lap passes g_0 p_s at null, 5-66
    leak under an overlap L     in series with the slot 12 mu L/(w c^3): g = g_0/(1 + 3 pi L/(8 c))
    flow force                  2 C_d C_v A d cos(theta), steady, shuts the land: 5-88

c is the radial clearance, w the perimeter that opens. An open land keeps g_0 beside its opening, so that flow is
continuous in the spool; g_0 follows from the leakage in the data sheet, the area from the rated flow. The flow force is
counted in shares of the command, proportional to A d, from the instant before: F = kappa sum A d/(A_rated d_rated).
Transient flow forces are left out.
"""

import math
from typing import NamedTuple

from numpy.typing import NDArray

from twin.kernel import inlined
from twin.land_law import Law, Laws, land_law
from twin.land_network import network_flows, port_pressures
from twin.lands import Lands, Ports, flows_apart
from twin.oil import Oil
from twin.orifice import Orifice, area_for
from twin.servo_opening import Opening, share_open
from twin.servo_spool import SPOOL_MEMORY, SpoolMotion, begin_spool, delayed, follow, played

FORCE, GUESS = SPOOL_MEMORY, SPOOL_MEMORY + 1  # of what the valve keeps: flow force, flows of the last instant
VALVE_MEMORY = GUESS + 4


class Edge(NamedTuple):
    """One land."""

    overlap: float  # share of the travel at which it opens; below 0: underlap
    area: float  # fully open [m^2]
    leak: float  # g_0 [m^3/(s Pa)]


class ServoValve(NamedTuple):
    """Positive spool positions connect P with A and B with T."""

    motion: SpoolMotion
    opening: Opening
    p_a: Edge
    b_t: Edge
    p_b: Edge
    a_t: Edge
    tightening: float  # 3 pi travel/(8 c): how fast a leak falls with the overlap, a share of the travel
    null_bias: float  # position of the spool at which the lands are symmetrical
    flow_force: float  # kappa/(A_rated d_rated) [1/N]
    orifice: Orifice


@inlined
def edge_area(way: float, edge: Edge, valve: ServoValve) -> float:
    """Area [m^2] of a land at a way of the spool in its direction."""
    if way <= edge.overlap:
        return 0.0
    return edge.area * share_open(valve.opening, (way - edge.overlap) / (1.0 - edge.overlap))


@inlined
def edge_leak(way: float, edge: Edge, valve: ServoValve) -> float:
    """Conductance of a land's clearance [m^3/(s Pa)]."""
    return edge.leak / (1.0 + valve.tightening * max(0.0, edge.overlap - way))


@inlined
def servo_areas(spool: float, valve: ServoValve) -> Lands:
    """Areas [m^2] at a spool position."""
    up, down = spool - valve.null_bias, valve.null_bias - spool
    return Lands(
        edge_area(up, valve.p_a, valve),
        edge_area(up, valve.b_t, valve),
        edge_area(down, valve.p_b, valve),
        edge_area(down, valve.a_t, valve),
        0.0,
    )


@inlined
def servo_leaks(spool: float, valve: ServoValve) -> Lands:
    """Conductances of the clearances [m^3/(s Pa)] at a spool position."""
    up, down = spool - valve.null_bias, valve.null_bias - spool
    return Lands(
        edge_leak(up, valve.p_a, valve),
        edge_leak(up, valve.b_t, valve),
        edge_leak(down, valve.p_b, valve),
        edge_leak(down, valve.a_t, valve),
        0.0,
    )


@inlined
def servo_laws(spool: float, valve: ServoValve, oil: Oil) -> Laws:
    """What each land takes at a spool position."""
    area, leak = servo_areas(spool, valve), servo_leaks(spool, valve)
    return Laws(
        land_law(area.p_a, leak.p_a, valve.orifice, oil),
        land_law(area.b_t, leak.b_t, valve.orifice, oil),
        land_law(area.p_b, leak.p_b, valve.orifice, oil),
        land_law(area.a_t, leak.a_t, valve.orifice, oil),
        Law(0.0, 1.0, 0.0, True),
    )


@inlined
def stands_apart(area: Lands, leak: Lands) -> bool:
    """Has each port one open land at most?"""
    up, down = area.p_a + area.b_t, area.p_b + area.a_t
    return leak.p_a + leak.b_t + leak.p_b + leak.a_t == 0.0 and (up == 0.0 or down == 0.0)


@inlined
def move_servo(
    position: float, speed: float, reference: float, valve: ServoValve, memory: NDArray, step: float
) -> tuple[float, float]:
    """Spool position and speed a step later under a reference -1..1."""
    command = delayed(played(reference, valve.motion, memory), valve.motion, memory)
    return follow(position, speed, command + memory[FORCE], valve.motion, step)


@inlined
def servo_flows(valve: ServoValve, spool: float, ports: Ports, memory: NDArray, oil: Oil) -> Lands:
    """Flows [m^3/s] through the lands between the ports; the memory keeps them, and the force they put on the spool."""
    area = servo_areas(spool, valve)
    if stands_apart(area, servo_leaks(spool, valve)):
        q = flows_apart(ports, area, valve.orifice, oil)
    else:
        guess = Lands(memory[GUESS], memory[GUESS + 1], memory[GUESS + 2], memory[GUESS + 3], 0.0)
        q, _ = network_flows(ports, servo_laws(spool, valve, oil), guess, oil)
    memory[GUESS], memory[GUESS + 1], memory[GUESS + 2], memory[GUESS + 3] = q.p_a, q.b_t, q.p_b, q.a_t
    memory[FORCE] = 0.0
    if valve.flow_force > 0.0:
        p, a, b, t = port_pressures(q, ports, oil.vapour_pressure)
        memory[FORCE] = flow_force(Lands(p - a, b - t, p - b, a - t, p - t), area, valve)
    return q


@inlined
def flow_force(drop: Lands, area: Lands, valve: ServoValve) -> float:
    """Force of the flow on the spool, in shares of the command: it shuts each land; drop [Pa], area [m^2] of each."""
    up, down = area.p_a * abs(drop.p_a) + area.b_t * abs(drop.b_t), area.p_b * abs(drop.p_b) + area.a_t * abs(drop.a_t)
    return valve.flow_force * (down - up)


def begin_servo(valve: ServoValve, position: float, flows: Lands, drop: Lands, memory: NDArray) -> None:
    """What the valve keeps that has been at rest at a spool position with flows [m^3/s] under drops [Pa]."""
    begin_spool(position, memory)
    memory[FORCE] = flow_force(drop, servo_areas(position, valve), valve) if valve.flow_force > 0.0 else 0.0
    memory[GUESS : GUESS + 4] = flows[:4]


def edge_of(rated: float, leak: float, overlap: float, ratio: float) -> Edge:
    """A land by the area [m^2] and the leak [m^3/(s Pa)] of the rated one."""
    return Edge(overlap, ratio * rated, ratio * leak)


def rated_area(rated_flow: float, rated_drop: float, leak: float, orifice: Orifice, oil: Oil) -> float:
    """Area [m^2] of a fully open land: with its leak it passes the rated flow at half of the rated drop."""
    drop = 0.5 * rated_drop
    if rated_flow <= leak * drop:
        raise ValueError(
            f"servo_valve.leakage alone passes {leak * drop:.3g} m^3/s at half of servo_valve.rated_drop, more than "
            f"servo_valve.rated_flow {rated_flow:g} m^3/s; take less leakage"
        )
    return area_for(rated_flow - leak * drop, drop, orifice, oil)


def tightening(travel: float, clearance: float) -> float:
    """How fast a leak falls with the overlap, counted in shares of the travel."""
    return 3.0 * math.pi * travel / (8.0 * clearance)
