"""The circuit: six lines, and the components that meet at their ends.

    tank -> pump -line 1- tee (relief valve) -line 2- P        A -line 3- lower chamber
                                              P, A, B, T: lands             piston
    tank <-line 6- return tee -line 5-                T        B -line 4- upper chamber

A wave that leaves a line's end comes back later, so within a step the ends know nothing of each other: each offers
p = c + Z q, and every component is solved alone, at the instant of the step's end. Only the cylinder has a step of
its own: half a kick of the piston by the pressures, its travel, oil into the chambers, half a kick by the new
pressures. `block` runs it on flat arrays; what a step reads and writes of the lines are the arrays of `Ends`.
"""

from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.accessory import INFLOW, LINE, Joined, Necks, accessory_neck, cushioned
from twin.accumulator import AnyAccumulator, fill_accumulator, with_accumulator
from twin.actuator import Actuator, counted, drive, fill_chambers
from twin.amplifier import Amplifiers, Direct
from twin.check_valve import AnyCheck
from twin.circuit.ends import (
    BACK_5,
    BACK_6,
    LOWER,
    PUMP,
    TANK,
    UPPER,
    A,
    B,
    Ends,
    P,
    Slots,
    T,
    deliver,
    port_at,
    set_pressure,
)
from twin.circuit.tee import AtTee, OwnLine, relief_side
from twin.contact import AnyStops, allowed_speed
from twin.cylinder import Chambers
from twin.directional_valve import Spool, Valve, move_valve, valve_flows
from twin.fitting import Fitting
from twin.friction import Friction, friction_force, slide
from twin.kernel import by_type, inlined
from twin.lands import Ports
from twin.lines.bank import Bank, arriving, departing
from twin.load import Weight
from twin.load_slot import AnyLoad, join, kick_second, move_load, push_of
from twin.minor_losses import Losses, resist
from twin.necked_cylinder import fill_behind_necks
from twin.oil import Oil
from twin.port import Port, joined, with_cavity
from twin.relief.motion import Motion
from twin.relief.slot import AnyRelief
from twin.return_end import AnyEnd, is_open_end, return_flow
from twin.supply import Supply, supply_flow


class Parts(NamedTuple):
    """All parameters that a step reads but for those of the lines."""

    step: float  # h [s]
    oil: Oil
    supply: Supply
    tee_accumulator: AnyAccumulator
    p_accumulator: AnyAccumulator  # at port P; one of the two at most
    relief: AnyRelief
    relief_place: AtTee | OwnLine
    fitting: Fitting  # in line 2, at the tee
    check: AnyCheck  # behind it
    return_end: AnyEnd  # of line 6
    valve: Valve
    necks: Joined | Necks  # between cylinder lines and chambers
    cylinder: Actuator
    seal: Friction
    stops: AnyStops
    load: AnyLoad
    losses: Losses  # at the ends of the lines
    amplifiers: Amplifiers | Direct  # before the card
    line_volume: float  # of all lines [m^3]


class Circuit(NamedTuple):
    """The whole rig."""

    parts: Parts
    lines: Bank


class Piston(NamedTuple):
    """Piston and load, upwards positive."""

    position: float  # x [m]
    velocity: float  # [m/s]


class Ledger(NamedTuple):
    """Oil that has crossed the border since the start [m^3 at reference density]."""

    pumped: float  # drawn from the tank
    relieved: float  # returned by the relief valve
    returned: float  # returned by line 6, and lost by the actuator to the outside


class Core(NamedTuple):
    """Everything with a memory outside the lines and their ends."""

    tick: float  # steps since the start
    piston: Piston
    spool: Spool
    weight: Weight
    chambers: Chambers  # stored oil [m^3]
    relief: Motion
    tee: float  # pressure that the tee would have had without the relief valve [Pa]
    ledger: Ledger


@inlined
def return_tee(ends: Ends, step: float) -> Port:
    """The port of lines 5 and 6, their cavity included."""
    port = joined(ends.free[BACK_5], ends.impedance[BACK_5], ends.free[BACK_6], ends.impedance[BACK_6])
    return with_cavity(port, ends.cavity[BACK_5], step)


@inlined
def supply_side(tick: float, ends: Ends, parts: Parts, slots: Slots) -> float:
    """The supply on its line; returns the oil it delivers [m^3/s]."""
    port, memory = port_at(PUMP, ends, parts.step), slots.supply
    delivered = supply_flow(parts.supply, tick, port, ends.pressure[PUMP], memory, parts.oil, parts.step)
    deliver(PUMP, port, delivered, ends, parts)
    return delivered


@inlined
def valve_side(spool: float, ends: Ends, parts: Parts, slots: Slots) -> None:
    """The directional valve between its four ports, and the accumulator at P."""
    h, alone, memory = parts.step, port_at(P, ends, parts.step), slots.accumulator
    p = with_accumulator(parts.p_accumulator, alone, memory, parts.oil, h)
    ports = Ports(p, port_at(A, ends, h), port_at(B, ends, h), port_at(T, ends, h))
    q = valve_flows(parts.valve, spool, ports, slots.valve, parts.oil)
    brought = -(q.p_a + q.p_b + q.p_t)
    drawn = fill_accumulator(parts.p_accumulator, alone, brought, memory, parts.oil, h)
    deliver(P, alone, brought - drawn, ends, parts)
    deliver(A, ports.a, q.p_a - q.a_t, ends, parts)
    deliver(B, ports.b, q.p_b - q.b_t, ends, parts)
    deliver(T, ports.t, q.b_t + q.a_t + q.p_t, ends, parts)


@inlined
def return_side(ends: Ends, parts: Parts) -> float:
    """Return tee, and what line 6 ends in; returns the flow that comes from the tank [m^3/s], < 0 as a rule."""
    p = deliver(BACK_5, return_tee(ends, parts.step), 0.0, ends, parts)
    set_pressure(BACK_6, p, ends)
    if is_open_end(parts.return_end):
        set_pressure(TANK, 0.0, ends)
        return ends.flow[TANK]
    port = port_at(TANK, ends, parts.step)
    q = return_flow(parts.return_end, port, parts.oil)
    deliver(TANK, port, q, ends, parts)
    return q


@inlined
def kick(piston: Piston, weight: Weight, p: Chambers, parts: Parts, slots: Slots, time: float) -> tuple[Piston, Weight]:
    """Piston and weight after a time [s] under constant pressures: their speeds change, their places not yet."""
    x, before, load = piston.position, piston.velocity, parts.load
    push = push_of(load, drive(p, x, parts.cylinder), x, before, weight, slots.load, time)
    after = slide(parts.seal, before, push.force, push.mass, abs(p.lower - p.upper), slots.friction, time)
    after = allowed_speed(parts.stops, x, after)
    return Piston(x, after), kick_second(load, push, x, 0.5 * (before + after), weight, slots.load, time)


@inlined
def seal_force(s: Core, ends: Ends, slots: Slots, parts: Parts) -> float:
    """Friction on the piston [N], in its direction: against the motion; at rest what holds, up to its limit."""
    p, x, v = Chambers(ends.pressure[LOWER], ends.pressure[UPPER]), s.piston.position, s.piston.velocity
    push = push_of(parts.load, drive(p, x, parts.cylinder), x, v, s.weight, slots.load, 0.0)
    return friction_force(parts.seal, v, push.force + push.contact, abs(p.lower - p.upper), slots.friction)


@inlined
def move_piston(piston: Piston, weight: Weight, parts: Parts, slots: Slots) -> tuple[Piston, Weight]:
    """Piston and weight a step later, under no force but the stops'."""
    x, v, then = move_load(parts.load, piston.position, piston.velocity, weight, parts.stops, slots.load, parts.step)
    return Piston(x, v), then


@by_type
def delivered(necks: Any, ends: Ends, slots: Slots) -> Chambers:
    """What the chambers give to their lines' ends [m^3/s]."""
    raise TypeError(f"{necks} are not what lies between lines and chambers")


@delivered.register
def _(necks: Joined, ends: Ends, slots: Slots) -> Chambers:
    return Chambers(ends.flow[LOWER], ends.flow[UPPER])


@delivered.register
def _(necks: Necks, ends: Ends, slots: Slots) -> Chambers:
    return Chambers(-slots.accessory_a[INFLOW], -slots.accessory_b[INFLOW])


@by_type
def cylinder_side(
    necks: Any, stored: Chambers, piston: Piston, ends: Ends, parts: Parts, slots: Slots
) -> tuple[Chambers, float]:
    """Both chambers at the ends of their lines, the piston at its new place, and oil lost to the outside [m^3]."""
    raise TypeError(f"{necks} are not what lies between lines and chambers")


@cylinder_side.register
def _(
    necks: Joined, stored: Chambers, piston: Piston, ends: Ends, parts: Parts, slots: Slots
) -> tuple[Chambers, float]:
    before = Chambers(ends.pressure[LOWER], ends.pressure[UPPER])
    inflow = Chambers(-ends.flow[LOWER], -ends.flow[UPPER])
    lower = Port(ends.free[LOWER], ends.impedance[LOWER])
    upper = Port(ends.free[UPPER], ends.impedance[UPPER])
    stored, p, lost = fill_chambers(stored, before, inflow, lower, upper, piston.position, parts.cylinder, parts.step)
    set_pressure(LOWER, p.lower, ends)
    set_pressure(UPPER, p.upper, ends)
    return stored, lost


@cylinder_side.register
def _(necks: Necks, stored: Chambers, piston: Piston, ends: Ends, parts: Parts, slots: Slots) -> tuple[Chambers, float]:
    h, oil, a, b = parts.step, parts.oil, slots.accessory_a, slots.accessory_b
    before, inflow = Chambers(ends.pressure[LOWER], ends.pressure[UPPER]), Chambers(a[INFLOW], b[INFLOW])
    line_a, line_b = a[LINE], b[LINE]
    neck_a = accessory_neck(necks.accessory_a, line_a, before.lower, line_b, a, oil, h)
    neck_b = accessory_neck(necks.accessory_b, line_b, before.upper, line_a, b, oil, h)
    neck_a, neck_b = cushioned(neck_a, neck_b, necks.cushion, piston.position)
    port_a, port_b = port_at(LOWER, ends, h), port_at(UPPER, ends, h)
    lower, upper = (port_a, neck_a), (port_b, neck_b)
    stored, p, q, lost = fill_behind_necks(
        stored, before, inflow, lower, upper, piston.position, parts.cylinder, oil, h
    )  # fmt: skip
    a[LINE], b[LINE] = deliver(LOWER, port_a, -q.lower, ends, parts), deliver(UPPER, port_b, -q.upper, ends, parts)
    a[INFLOW], b[INFLOW] = q.lower, q.upper
    ends.pressure[LOWER], ends.pressure[UPPER] = p.lower, p.upper
    return stored, lost


@inlined
def count_oil(oil: NDArray, flow: NDArray, before: Chambers, then: Chambers, step: float) -> None:
    """Oil of the lines after a step; before, then: what the chambers deliver to them, whose mean counts."""
    for line in range(len(oil)):
        oil[line] += step * (flow[2 * line] + flow[2 * line + 1])
    oil[2] += 0.5 * step * (before.lower - then.lower)
    oil[3] += 0.5 * step * (before.upper - then.upper)


@inlined
def step_once(s: Core, reference: float, parts: Parts, bank: Bank, ends: Ends, slots: Slots, memory: NDArray) -> Core:
    """One step under a spool reference -1..1: `ends` and the memories of slots and lines change in place."""
    h, tick = parts.step, s.tick + 1.0
    given = delivered(parts.necks, ends, slots)
    p = Chambers(ends.pressure[LOWER], ends.pressure[UPPER])
    piston, weight = kick(s.piston, s.weight, p, parts, slots, 0.5 * h)
    piston, weight = move_piston(piston, weight, parts, slots)
    spool = move_valve(parts.valve, s.spool, reference, slots.valve, h)
    arriving(bank, memory, int(tick), ends.free, ends.impedance)
    resist(parts.losses, ends.flow, ends.impedance)
    pumped = supply_side(tick, ends, parts, slots)
    relief, tee = relief_side(parts.relief_place, s.relief, s.tee, ends, parts, slots)
    valve_side(spool.position, ends, parts, slots)
    stored = counted(parts.cylinder, s.chambers, p, s.piston.position, piston.position)
    chambers, lost = cylinder_side(parts.necks, stored, piston, ends, parts, slots)
    returned = return_side(ends, parts)
    departing(bank, memory, int(tick), ends.flow)
    count_oil(ends.oil, ends.flow, given, delivered(parts.necks, ends, slots), h)
    p = Chambers(ends.pressure[LOWER], ends.pressure[UPPER])
    piston, weight = kick(piston, weight, p, parts, slots, 0.5 * h)
    velocity, weight = join(parts.load, piston.position, piston.velocity, weight)
    ledger = Ledger(
        s.ledger.pumped + h * pumped,
        s.ledger.relieved + h * relief.flow,
        s.ledger.returned - h * returned + lost,
    )
    return Core(tick, Piston(piston.position, velocity), spool, weight, chambers, relief, tee, ledger)
