"""The circuit: nine nodes, six lines between them, and the components that meet at their ends.

    tank -> pump -line 1- tee (relief valve) -line 2- P        A -line 3- lower chamber
                                              P, A, B, T: lands             piston
    tank <-line 6- return tee -line 5-                T        B -line 4- upper chamber

A step is a Strang splitting: everything with inertia (piston, line flows) gets half a kick from the pressures, the
nodes fill for a whole step at these speeds, then comes the other half. It is symmetric, of second order, conserves
oil to rounding and cannot pump energy into a resonance. Within the filling each node meets one resistance at most
(lands, relief valve, leak: solved exactly; pump: linearised), so nothing stiff is left and nothing iterates.
"""

import math
from typing import NamedTuple

from twin.contact import Stops, held, travel
from twin.cylinder import Cylinder, Load, chamber_volumes, drive
from twin.exchange import exchange
from twin.kernel import kernel
from twin.lines.lumped import LumpedLine, accelerate
from twin.node import Node, cavity, pressure
from twin.oil import Oil
from twin.orifice import resistance
from twin.pump import Pump, pumped_oil
from twin.relief import Relief, relieve
from twin.seal import Seal, slide
from twin.spool_valve import SpoolValve, move_spool, opening


class Circuit(NamedTuple):
    """All parameters that a step reads."""

    step: float  # h [s]
    oil: Oil
    pump: Pump
    relief: Relief
    valve: SpoolValve
    cylinder: Cylinder
    seal: Seal
    stops: Stops
    load: Load
    line_1: LumpedLine  # pump -> relief tee
    line_2: LumpedLine  # relief tee -> P, with the filter
    line_3: LumpedLine  # A -> lower chamber
    line_4: LumpedLine  # B -> upper chamber
    line_5: LumpedLine  # T -> return tee
    line_6: LumpedLine  # return tee -> tank


class Stored(NamedTuple):
    """Oil per node [m^3 at reference density]."""

    pump: float
    tee: float
    p: float
    a: float
    lower: float
    upper: float
    b: float
    t: float
    back: float


class Flows(NamedTuple):
    """Flow per line [m^3/s], positive in the order of its name in the circuit's picture (3 and 4: to the chamber)."""

    line_1: float
    line_2: float
    line_3: float
    line_4: float
    line_5: float
    line_6: float


class Piston(NamedTuple):
    """Piston and load, upwards positive."""

    position: float  # x [m]
    velocity: float  # [m/s]


class Spool(NamedTuple):
    """Spool of the proportional valve, in shares of its travel."""

    position: float  # -1..1
    velocity: float  # [1/s]


class Ledger(NamedTuple):
    """Oil that has crossed the border since the start [m^3 at reference density]."""

    pumped: float  # drawn from the tank
    relieved: float  # returned by the relief valve
    returned: float  # returned by line 6


class State(NamedTuple):
    """Everything that has a memory."""

    oil: Stored
    flows: Flows
    piston: Piston
    spool: Spool
    ledger: Ledger


class Nodes(NamedTuple):
    """The nine nodes of a state."""

    pump: Node
    tee: Node
    p: Node
    a: Node
    lower: Node
    upper: Node
    b: Node
    t: Node
    back: Node


class Pressures(NamedTuple):
    """Gauge pressures [Pa] of the nine nodes."""

    pump: float
    tee: float
    p: float
    a: float
    lower: float
    upper: float
    b: float
    t: float
    back: float


@kernel
def nodes(oil: Stored, position: float, c: Circuit) -> Nodes:
    """Stored oil, volume and capacity of each node, the piston at a position [m]."""
    v_lower, v_upper = chamber_volumes(position, c.cylinder)
    compliance = 1.0 / c.oil.bulk_modulus
    l1, l2, l3, l4, l5, l6 = c.line_1, c.line_2, c.line_3, c.line_4, c.line_5, c.line_6
    return Nodes(
        Node(oil.pump, l1.end_volume, l1.end_capacity),
        Node(oil.tee, l1.end_volume + l2.end_volume, l1.end_capacity + l2.end_capacity),
        Node(oil.p, l2.end_volume, l2.end_capacity),
        Node(oil.a, l3.end_volume, l3.end_capacity),
        Node(oil.lower, l3.end_volume + v_lower, l3.end_capacity + v_lower * compliance),
        Node(oil.upper, l4.end_volume + v_upper, l4.end_capacity + v_upper * compliance),
        Node(oil.b, l4.end_volume, l4.end_capacity),
        Node(oil.t, l5.end_volume, l5.end_capacity),
        Node(oil.back, l5.end_volume + l6.end_volume, l5.end_capacity + l6.end_capacity),
    )


@kernel
def pressures(s: State, c: Circuit) -> Pressures:
    """Gauge pressures [Pa], none below the vapour pressure."""
    n, vapour = nodes(s.oil, s.piston.position, c), c.oil.vapour_pressure
    return Pressures(
        pressure(n.pump, vapour),
        pressure(n.tee, vapour),
        pressure(n.p, vapour),
        pressure(n.a, vapour),
        pressure(n.lower, vapour),
        pressure(n.upper, vapour),
        pressure(n.b, vapour),
        pressure(n.t, vapour),
        pressure(n.back, vapour),
    )


@kernel
def chamber_cavities(s: State, c: Circuit) -> tuple[float, float]:
    """Vapour [m^3] in the lower and the upper chamber."""
    n = nodes(s.oil, s.piston.position, c)
    return cavity(n.lower, c.oil.vapour_pressure), cavity(n.upper, c.oil.vapour_pressure)


@kernel
def kick_flows(q: Flows, p: Pressures, c: Circuit, time: float) -> Flows:
    """Line flows after a time [s] under constant pressures."""
    return Flows(
        accelerate(q.line_1, p.pump - p.tee, c.line_1, time),
        accelerate(q.line_2, p.tee - p.p, c.line_2, time),
        accelerate(q.line_3, p.a - p.lower, c.line_3, time),
        accelerate(q.line_4, p.b - p.upper, c.line_4, time),
        accelerate(q.line_5, p.t - p.back, c.line_5, time),
        accelerate(q.line_6, p.back, c.line_6, time),
    )


@kernel
def kick_piston(piston: Piston, p: Pressures, c: Circuit, time: float) -> Piston:
    """The piston after a time [s] under constant pressures: its speed changes, its place not yet."""
    force = drive(p.lower, p.upper, c.cylinder, c.load)
    velocity = slide(piston.velocity, force, c.load.mass, abs(p.lower - p.upper), c.seal, time)
    return Piston(piston.position, held(piston.position, velocity, c.stops))


@kernel
def through_lines(oil: Stored, q: Flows, step: float) -> Stored:
    """Stored oil after the lines have carried their flows for a step."""
    return Stored(
        oil.pump - step * q.line_1,
        oil.tee + step * (q.line_1 - q.line_2),
        oil.p + step * q.line_2,
        oil.a - step * q.line_3,
        oil.lower + step * q.line_3,
        oil.upper + step * q.line_4,
        oil.b - step * q.line_4,
        oil.t - step * q.line_5,
        oil.back + step * (q.line_5 - q.line_6),
    )


@kernel
def through_pump(before: float, node: Node, pump: Pump, oil: Oil, step: float) -> float:
    """Mean oil flow [m^3/s] from the pump into its node, trapezoidal rule, linearised about the pressure before."""
    inflow, slope = pumped_oil(before, pump, oil.bulk_modulus)
    free = (node.stored + step * (inflow - 0.5 * slope * before) - node.volume) / node.capacity
    after = max(oil.vapour_pressure, free / (1.0 - 0.5 * step * slope / node.capacity))
    return inflow + 0.5 * slope * (after - before)


@kernel
def through_land(drop: float, source: Node, sink: Node, area: float, c: Circuit) -> float:
    """Mean flow [m^3/s] through a land of an area [m^2] during a step."""
    if area <= 0.0:
        return 0.0
    a, b = resistance(area, c.valve.orifice, c.oil)
    return exchange(drop, source, sink, a, b, c.oil.vapour_pressure, c.step)


@kernel
def through_leak(drop: float, lower: Node, upper: Node, c: Circuit) -> float:
    """Mean flow [m^3/s] across the piston seal during a step."""
    if c.cylinder.leakage_resistance == math.inf:
        return 0.0
    return exchange(drop, lower, upper, 0.0, c.cylinder.leakage_resistance, c.oil.vapour_pressure, c.step)


@kernel
def through_components(
    oil: Stored, n: Nodes, before: Pressures, spool: float, ledger: Ledger, c: Circuit
) -> tuple[Stored, Ledger]:
    """Stored oil after pump, relief valve, leak and lands have passed their flows for a step.

    before: pressures at the start of the step; n: nodes at its end; spool: its position halfway.
    """
    h = c.step
    supply = h * through_pump(before.pump, n.pump, c.pump, c.oil, h)
    bypass = h * relieve(before.tee, n.tee, c.relief, h)
    leak = h * through_leak(before.lower - before.upper, n.lower, n.upper, c)
    up, down = opening(spool, c.valve), opening(-spool, c.valve)
    p_a = h * through_land(before.p - before.a, n.p, n.a, up, c)
    b_t = h * through_land(before.b - before.t, n.b, n.t, up, c)
    p_b = h * through_land(before.p - before.b, n.p, n.b, down, c)
    a_t = h * through_land(before.a - before.t, n.a, n.t, down, c)
    filled = Stored(
        oil.pump + supply,
        oil.tee - bypass,
        oil.p - p_a - p_b,
        oil.a + p_a - a_t,
        oil.lower - leak,
        oil.upper + leak,
        oil.b + p_b - b_t,
        oil.t + b_t + a_t,
        oil.back,
    )
    return filled, Ledger(ledger.pumped + supply, ledger.relieved + bypass, ledger.returned)


@kernel
def step_once(s: State, before: Pressures, reference: float, c: Circuit) -> tuple[State, Pressures]:
    """One step: half a kick, positions and oil for the whole step, half a kick. Returns the pressures after it."""
    half = 0.5 * c.step
    q = kick_flows(s.flows, before, c, half)
    kicked = kick_piston(s.piston, before, c, half)
    spool = Spool(*move_spool(s.spool.position, s.spool.velocity, reference, c.valve, c.step))
    piston = Piston(*travel(kicked.position, kicked.velocity, c.stops, c.step))
    carried = through_lines(s.oil, q, c.step)
    ledger = Ledger(s.ledger.pumped, s.ledger.relieved, s.ledger.returned + c.step * q.line_6)
    halfway = 0.5 * (s.spool.position + spool.position)
    oil, ledger = through_components(carried, nodes(carried, piston.position, c), before, halfway, ledger, c)
    after = pressures(State(oil, q, piston, spool, ledger), c)
    return State(oil, kick_flows(q, after, c, half), kick_piston(piston, after, c, half), spool, ledger), after


@kernel
def advance(s: State, reference: float, c: Circuit, steps: int) -> tuple[State, State]:
    """The state `steps` steps later under a constant spool reference (-1..1), and the one a step before that."""
    previous = s
    before = pressures(s, c)
    for _ in range(steps):
        previous = s
        s, before = step_once(s, before, reference, c)
    return s, previous


def stored_oil(s: State) -> float:
    """Oil in the whole circuit [m^3 at reference density]; its change is pumped - relieved - returned."""
    return sum(s.oil)
