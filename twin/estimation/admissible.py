"""What a linear combination of states may break: a member is made one that its twin could have come to.

Pressures are what is combined: the oil of a chamber follows from its pressure, its place and its modulus. Lifts,
cavities and places keep within their bounds, a weight is carried or not, and a body at a stop does not move into it.
"""

from typing import Any

from twin.accumulator import OIL as ACCUMULATED
from twin.actuator import stored_oil
from twin.circuit.ends import TEE_1
from twin.circuit.state import MEMORY_AT, ends_of, load, slots_of, store
from twin.circuit.step import LOWER, UPPER, Core, Parts, Piston
from twin.contact import NoStops, Stops, allowed_speed, stopped
from twin.cylinder import Chambers
from twin.directional_valve import Spool
from twin.kernel import by_type, inlined, kernel
from twin.lines import nodes
from twin.lines.bank import unpacked
from twin.load import Weight
from twin.relief.direct import DirectRelief
from twin.relief.motion import Motion, ReliefState, begin
from twin.relief.network import Relief
from twin.relief.slot import NoRelief


@by_type
def within(stops: Any, position: float) -> float:
    """A place [m] that the stops allow."""
    raise TypeError(f"{stops} are not stops")


@within.register
def _(stops: Stops, position: float) -> float:
    return min(max(position, 0.0), stops.stroke)


@within.register
def _(stops: NoStops, position: float) -> float:
    return position


@inlined
def _weight(weight: Weight, x: float) -> Weight:
    if weight.carried >= 0.5:
        return Weight(x, 0.0, 1.0)
    return Weight(weight.position, weight.velocity, 0.0)


@by_type
def settled(valve: Any, m: Motion, p: float) -> Motion:
    """The relief valve within its bounds, at an inlet pressure [Pa]."""
    raise TypeError(f"{valve} is not a relief valve")


@settled.register
def _(valve: DirectRelief | NoRelief, m: Motion, p: float) -> Motion:
    return m


@settled.register
def _(valve: Relief, m: Motion, p: float) -> Motion:
    """Lifts and speeds are combined; the pressures and forces inside follow, since shut seats count them otherwise."""
    s, pilot, main = m.state, valve.pilot.stops, valve.main.stops
    lift, spool = min(max(0.0, s.pilot_lift), pilot.stroke), min(max(0.0, s.spool_lift), main.stroke)
    state = ReliefState(lift, stopped(lift, s.pilot_velocity, pilot), spool, stopped(spool, s.spool_velocity, main))
    return begin(state, p, max(0.0, m.flow), valve, m.rise, m.rise_before)


@inlined
def _stored(kept: Chambers, p: Chambers, x: float, c: Parts) -> Chambers:
    """Oil of the chambers [m^3] at pressures; of one with a cavity what it had, which is no more than fills it."""
    filled, vapour = stored_oil(p, x, c.cylinder), c.cylinder.vapour_pressure
    lower = min(kept.lower, filled.lower) if p.lower <= vapour else filled.lower
    upper = min(kept.upper, filled.upper) if p.upper <= vapour else filled.upper
    return Chambers(lower, upper)


@inlined
def _admit(s: Core, ends, c: Parts) -> Core:
    x = within(c.stops, s.piston.position)
    piston = Piston(x, allowed_speed(c.stops, x, s.piston.velocity))
    spool = Spool(min(max(s.spool.position, -1.0), 1.0), s.spool.velocity)
    vapour = c.cylinder.vapour_pressure
    p = Chambers(max(ends.pressure[LOWER], vapour), max(ends.pressure[UPPER], vapour))
    stored = _stored(s.chambers, p, x, c)
    relief = settled(c.relief, s.relief, ends.pressure[TEE_1])
    return Core(s.tick, piston, spool, _weight(s.weight, x), stored, relief, s.tee, s.ledger)


@kernel
def admit(parts, whole, numbers, states) -> None:
    """Make all members admissible, in place; parts: a record of `Parts` for each, whole, numbers: of `Compiled`."""
    lines = unpacked(whole, numbers)
    for m in range(len(states)):
        c, state = parts[m], states[m]
        ends, slots, memory = ends_of(state), slots_of(state), state[MEMORY_AT:]
        for end in range(len(ends.cavity)):
            ends.cavity[end] = max(0.0, ends.cavity[end])
            ends.pressure[end] = max(c.oil.vapour_pressure, ends.pressure[end])
        store(_admit(load(state), ends, c), state)
        slots.accumulator[ACCUMULATED] = max(0.0, slots.accumulator[ACCUMULATED])
        for place in lines.nodes_place:
            for i in range(nodes.LANES):
                at = place + nodes.CAVITY * nodes.LANES + i
                memory[at] = max(0.0, memory[at])
