"""The circuit: six lines, and the components that meet at their ends.

    tank -> pump -line 1- tee (relief valve) -line 2- P        A -line 3- lower chamber
                                              P, A, B, T: lands             piston
    tank <-line 6- return tee -line 5-                T        B -line 4- upper chamber

A wave that leaves a line's end comes back later, so within a step the ends know nothing of each other: each offers
p = c + Z q, and every component is solved alone, at the instant of the step's end. Only the cylinder has a step of
its own: half a kick of the piston by the pressures, its travel, oil into the chambers, half a kick by the new
pressures. `block` runs it on flat arrays; what a step reads and writes of the lines are the arrays of `Ends`.
"""

import math
from typing import NamedTuple

from numpy.typing import NDArray

from twin.amplifier import Amplifiers, Direct
from twin.contact import Stops, stopped, travel
from twin.cylinder import Chambers, Cylinder, drive, fill_chambers
from twin.fitting import Fitting, fitting_resistance
from twin.kernel import inlined
from twin.lands import Lands, Ports, land_flows
from twin.lines.bank import Bank, arriving, departing
from twin.load import Load, Weight, carried_mass, contact_force, kick_weight, move_weight, pick_up
from twin.minor_losses import Losses, resist
from twin.oil import Oil
from twin.port import Port, cavity, joined, pressure, with_cavity
from twin.pump import Pump, pumped_oil, ripple_flow, speed_ratio
from twin.relief.motion import Motion
from twin.relief.valve import Relief, step_valve
from twin.seal import Seal, friction, friction_limit, slide
from twin.spool_valve import SpoolValve, closed_centre_lands, move_spool
from twin.switching_valve import SwitchingValve, switch_spool, tandem_lands
from twin.topology import ENDS, LINES

PUMP, TEE_1, TEE_2, P, A, LOWER, B, UPPER, T, BACK_5, BACK_6, TANK = range(len(ENDS))


class Fitted(NamedTuple):
    """Which parts the circuit has: 1.0 for yes."""

    relief: float  # else the tee has no valve
    switching: float  # the switching valve in place of the proportional one


class Parts(NamedTuple):
    """All parameters that a step reads but for those of the lines."""

    step: float  # h [s]
    fitted: Fitted
    oil: Oil
    pump: Pump
    relief: Relief
    fitting: Fitting  # in line 2, at the tee
    valve: SpoolValve
    switching: SwitchingValve
    cylinder: Cylinder
    seal: Seal
    stops: Stops
    load: Load
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


class Spool(NamedTuple):
    """Spool of the directional valve, in shares of its travel."""

    position: float  # -1..1
    velocity: float  # [1/s]


class Ledger(NamedTuple):
    """Oil that has crossed the border since the start [m^3 at reference density]."""

    pumped: float  # drawn from the tank
    relieved: float  # returned by the relief valve
    returned: float  # returned by line 6


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


class Ends(NamedTuple):
    """The twelve line ends at the last instant, in the order of ENDS, and the oil of the six lines."""

    pressure: NDArray  # [Pa]
    flow: NDArray  # into the line [m^3/s]
    cavity: NDArray  # [m^3]; of a tee at its first end, behind the fittings at TEE_2, of a chamber not here
    free: NDArray  # c [Pa]
    impedance: NDArray  # Z [Pa s/m^3]
    oil: NDArray  # in each line, beyond what fills it at no pressure [m^3 at reference density]


@inlined
def port_at(end: int, ends: Ends, step: float) -> Port:
    """The port of one line end, its cavity included."""
    return with_cavity(Port(ends.free[end], ends.impedance[end]), ends.cavity[end], step)


@inlined
def relief_tee(ends: Ends, parts: Parts) -> tuple[Port, Port]:
    """The port of the relief valve, and what it sees of line 2 through the fittings: the cavity behind them, if any."""
    resistance = fitting_resistance(ends.flow[TEE_2], parts.fitting)
    behind = Port(ends.free[TEE_2], ends.impedance[TEE_2] + resistance)
    if ends.cavity[TEE_2] > 0.0 and resistance > 0.0:
        behind = Port(parts.oil.vapour_pressure, resistance)
    port = joined(ends.free[TEE_1], ends.impedance[TEE_1], behind.free, behind.impedance)
    return with_cavity(port, ends.cavity[TEE_1], parts.step), behind


@inlined
def return_tee(ends: Ends, step: float) -> Port:
    """The port of lines 5 and 6, their cavity included."""
    port = joined(ends.free[BACK_5], ends.impedance[BACK_5], ends.free[BACK_6], ends.impedance[BACK_6])
    return with_cavity(port, ends.cavity[BACK_5], step)


@inlined
def set_pressure(end: int, p: float, ends: Ends) -> None:
    """A line end takes a pressure."""
    ends.pressure[end] = p
    ends.flow[end] = (p - ends.free[end]) / ends.impedance[end]


@inlined
def deliver(end: int, port: Port, flow: float, ends: Ends, parts: Parts) -> float:
    """One line end takes what a component delivers; returns the pressure."""
    p = pressure(port, flow, parts.oil.vapour_pressure)
    ends.cavity[end] = cavity(port, flow, p, parts.step) if p == parts.oil.vapour_pressure else 0.0
    set_pressure(end, p, ends)
    return p


@inlined
def pump_side(tick: float, ends: Ends, parts: Parts) -> float:
    """The pump on its line; returns the oil it delivers [m^3/s]. Its leakage is linearised about the last pressure."""
    port, before = port_at(PUMP, ends, parts.step), ends.pressure[PUMP]
    time = tick * parts.step
    mean, slope = pumped_oil(before, speed_ratio(time, parts.pump), parts.pump, parts.oil.bulk_modulus)
    ripple = ripple_flow(time + 0.5 * parts.step, parts.step, parts.pump)
    inflow = mean + ripple - slope * before
    p = max(parts.oil.vapour_pressure, (port.free + port.impedance * inflow) / (1.0 - port.impedance * slope))
    delivered = inflow + slope * p
    deliver(PUMP, port, delivered, ends, parts)
    return delivered


@inlined
def relief_side(relief: Motion, before: float, ends: Ends, parts: Parts) -> tuple[Motion, float]:
    """The relief valve at its tee, and the pressure the tee would have without it; before: that of the last instant."""
    port, behind = relief_tee(ends, parts)
    if parts.fitted.relief == 1.0:
        relief, _ = step_valve(relief, before, port.free, port.impedance, parts.relief, parts.step)
    p = deliver(TEE_1, port, -relief.flow, ends, parts)
    deliver(TEE_2, port_at(TEE_2, ends, parts.step), (p - behind.free) / behind.impedance, ends, parts)
    return relief, port.free


@inlined
def move_valve(spool: Spool, reference: float, parts: Parts) -> Spool:
    """The spool of the valve that is fitted, a step later."""
    if parts.fitted.switching == 1.0:
        return Spool(*switch_spool(spool.position, reference, parts.switching, parts.step))
    return Spool(*move_spool(spool.position, spool.velocity, reference, parts.valve, parts.step))


@inlined
def land_areas(spool: float, parts: Parts) -> Lands:
    """Areas [m^2] of the valve that is fitted."""
    if parts.fitted.switching == 1.0:
        return tandem_lands(spool, parts.switching)
    return closed_centre_lands(spool, parts.valve)


@inlined
def valve_side(spool: float, ends: Ends, parts: Parts) -> None:
    """The directional valve between its four ports."""
    h = parts.step
    ports = Ports(port_at(P, ends, h), port_at(A, ends, h), port_at(B, ends, h), port_at(T, ends, h))
    orifice = parts.switching.orifice if parts.fitted.switching == 1.0 else parts.valve.orifice
    q = land_flows(ports, land_areas(spool, parts), orifice, parts.oil)
    deliver(P, ports.p, -(q.p_a + q.p_b + q.p_t), ends, parts)
    deliver(A, ports.a, q.p_a - q.a_t, ends, parts)
    deliver(B, ports.b, q.p_b - q.b_t, ends, parts)
    deliver(T, ports.t, q.b_t + q.a_t + q.p_t, ends, parts)


@inlined
def return_side(ends: Ends, parts: Parts) -> None:
    """Return tee and tank."""
    p = deliver(BACK_5, return_tee(ends, parts.step), 0.0, ends, parts)
    set_pressure(BACK_6, p, ends)
    set_pressure(TANK, 0.0, ends)


@inlined
def kick(piston: Piston, weight: Weight, p: Chambers, parts: Parts, time: float) -> tuple[Piston, Weight]:
    """Piston and weight after a time [s] under constant pressures: their speeds change, their places not yet."""
    load = parts.load
    mass, push = carried_mass(weight, load), contact_force(piston.position, weight, load)
    force = drive(p, parts.cylinder) - mass * load.gravity + load.force - push
    velocity = slide(piston.velocity, force, mass, abs(p.lower - p.upper), parts.seal, time)
    kicked = kick_weight(weight, push, load, time)
    return Piston(piston.position, stopped(piston.position, velocity, parts.stops)), kicked


@inlined
def seal_force(s: Core, ends: Ends, parts: Parts) -> float:
    """Force of the seals on the piston [N], upwards: against the motion; at rest what holds, up to its limit."""
    p = Chambers(ends.pressure[LOWER], ends.pressure[UPPER])
    sealing, v = abs(p.lower - p.upper), s.piston.velocity
    if v != 0.0:
        return -math.copysign(friction(v, sealing, parts.seal)[0], v)
    load = parts.load
    push = drive(p, parts.cylinder) - carried_mass(s.weight, load) * load.gravity + load.force
    most = friction_limit(push, sealing, parts.seal)
    return min(max(-push, -most), most)


@inlined
def move_piston(piston: Piston, weight: Weight, parts: Parts) -> tuple[Piston, Weight]:
    """Piston and weight a step later at constant speeds."""
    moved = Piston(*travel(piston.position, piston.velocity, parts.stops, parts.step))
    return moved, move_weight(weight, moved.position, parts.load, parts.step)


@inlined
def cylinder_side(stored: Chambers, piston: Piston, ends: Ends, parts: Parts) -> Chambers:
    """Both chambers at the ends of their lines, the piston at its new place."""
    before = Chambers(ends.pressure[LOWER], ends.pressure[UPPER])
    inflow = Chambers(-ends.flow[LOWER], -ends.flow[UPPER])
    lower = Port(ends.free[LOWER], ends.impedance[LOWER])
    upper = Port(ends.free[UPPER], ends.impedance[UPPER])
    stored, p = fill_chambers(stored, before, inflow, lower, upper, piston.position, parts.cylinder, parts.step)
    set_pressure(LOWER, p.lower, ends)
    set_pressure(UPPER, p.upper, ends)
    return stored


@inlined
def count_oil(oil: NDArray, flow: NDArray, lower: float, upper: float, step: float) -> None:
    """Oil of the lines after a step; lower, upper: flows into them from the chambers before it, whose mean counts."""
    for line in range(LINES):
        oil[line] += step * (flow[2 * line] + flow[2 * line + 1])
    oil[2] += 0.5 * step * (lower - flow[LOWER])
    oil[3] += 0.5 * step * (upper - flow[UPPER])


@inlined
def step_once(s: Core, reference: float, parts: Parts, bank: Bank, ends: Ends, memory: NDArray) -> Core:
    """One step under a spool reference -1..1: `ends` and the memory of the lines change in place."""
    h, tick = parts.step, s.tick + 1.0
    lower, upper = ends.flow[LOWER], ends.flow[UPPER]
    piston, weight = kick(s.piston, s.weight, Chambers(ends.pressure[LOWER], ends.pressure[UPPER]), parts, 0.5 * h)
    piston, weight = move_piston(piston, weight, parts)
    spool = move_valve(s.spool, reference, parts)
    arriving(bank, memory, int(tick), ends.free, ends.impedance)
    resist(parts.losses, ends.flow, ends.impedance)
    pumped = pump_side(tick, ends, parts)
    relief, tee = relief_side(s.relief, s.tee, ends, parts)
    valve_side(spool.position, ends, parts)
    chambers = cylinder_side(s.chambers, piston, ends, parts)
    return_side(ends, parts)
    departing(bank, memory, int(tick), ends.flow)
    count_oil(ends.oil, ends.flow, lower, upper, h)
    piston, weight = kick(piston, weight, Chambers(ends.pressure[LOWER], ends.pressure[UPPER]), parts, 0.5 * h)
    velocity, weight = pick_up(piston.position, piston.velocity, weight, parts.load)
    ledger = Ledger(
        s.ledger.pumped + h * pumped,
        s.ledger.relieved + h * relief.flow,
        s.ledger.returned - h * ends.flow[TANK],
    )
    return Core(tick, Piston(piston.position, velocity), spool, weight, chambers, relief, tee, ledger)
