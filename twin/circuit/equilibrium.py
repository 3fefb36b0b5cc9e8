"""Where a run starts: valve at rest, load held by the lower chamber, pump over relief valve or tandem centre."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from twin.accessory import INFLOW, LINE, Necks, begin_accessory, resting_neck
from twin.accumulator import begin_accumulator
from twin.actuator import Actuator, areas, stored_oil
from twin.check_valve import cracking_drop, is_check
from twin.circuit.ends import TEE_1, TEE_2, VALVE_END
from twin.circuit.open_centre import laws_at_rest, passed, steady_lands, upper_pressure
from twin.circuit.state import Flows, Pressures, State
from twin.circuit.step import LOWER, TANK, UPPER, AtTee, Circuit, Core, Ends, Ledger, OwnLine, Piston, Slots
from twin.cylinder import Chambers
from twin.directional_valve import Spool, begin_valve, land_orifice, lands_at
from twin.fitting import fitting_resistance
from twin.kernel import interpreted
from twin.lands import Lands
from twin.lines.bank import arriving, memory_size, settle, steady_drop
from twin.load import Load, Weight, weight_at
from twin.load_at_rest import begin_load, held_force
from twin.load_slot import AnyLoad
from twin.minor_losses import loss_at_end, minor_drop, resist
from twin.neck import steady_flow
from twin.orifice import resistance
from twin.port import joined
from twin.relief.slot import begin_relief, steady_relief
from twin.return_end import steady_end
from twin.supply import begin_supply, starting_ratio, steady_supply
from twin.topology import END_COUNT, ENDS, LINES, PLACES, SLOT_SIZES, TAPS
from twin.variable_pump import VariablePump

OWN_LINE = LINES  # of the relief valve, behind the six
TIGHT = 1e-14  # [m^3/s]
HIGHEST = 1e10  # [Pa]


class SupplyAtRest(NamedTuple):
    """What the pump does while the cylinder is shut in."""

    pump: float  # pressure at the pump [Pa]
    tee: float  # pressure at the relief valve [Pa]
    relieved: float  # flow over the relief valve [m^3/s]
    idle: float  # flow through the valve's centre to the tank [m^3/s]


def supply_at_rest(circuit: Circuit, ratio: float = 1.0) -> SupplyAtRest:
    """Where pump, relief valve and the valve's centre position balance; ratio: of the pump's full speed."""

    def at(tee: float) -> tuple[SupplyAtRest, float]:
        relieved = relieved_at(tee, circuit)[0]
        idle = idle_flow(tee, circuit)
        pump = tee + line_drop(0, relieved + idle, circuit)
        delivered = steady_supply(circuit.parts.supply, pump, ratio, circuit.parts.oil)[0]
        return SupplyAtRest(pump, tee, relieved, idle), delivered - relieved - idle

    if at(0.0)[1] <= TIGHT:  # pump off: any pressure below cracking stays
        return at(0.0)[0]
    high = 1e5
    while at(high)[1] > 0.0:
        high *= 2.0
        if high > HIGHEST:
            raise ValueError(
                "the pump flow has no outlet: no relief valve, a shut valve and no leakage; "
                "take relief.kind = 'two-stage', a tandem centre or a supply that leaks (pump.efficiency below 1)"
            )
    spare = TIGHT if isinstance(circuit.parts.supply, VariablePump) else 0.0  # it may swing back to nothing
    return at(_root(lambda tee: at(tee)[1] - spare, high, 1e-6))[0]


def idle_flow(tee: float, circuit: Circuit) -> float:
    """Flow [m^3/s] from the tee through the valve at rest to the tank, at a pressure [Pa] at the tee."""
    area = lands_at(circuit.parts.valve, 0.0).p_t
    if tee <= 0.0:
        return 0.0
    if area <= 0.0:
        return _through_lands(tee, circuit)

    def excess(flow: float) -> float:
        return tee - sum(_idle_drops(flow, area, circuit))

    high = 1e-6
    while excess(high) > 0.0:
        high *= 2.0
    return _root(excess, high, 1e-18)


def _through_lands(tee: float, circuit: Circuit) -> float:
    """Flow [m^3/s] through a servo valve's lands with its ports A and B blocked."""
    laws = laws_at_rest(circuit)
    if laws is None or behind_check(tee, circuit) <= 0.0:
        return 0.0

    def excess(drop: float) -> float:
        return tee - drop - sum(_idle_lines(passed(drop, laws), circuit))

    return passed(_root(excess, tee, 1e-6), laws)


def _root(function: Callable[[float], float], high: float, tolerance: float) -> float:
    """Where a function changes its sign between 0 and `high`."""
    from scipy.optimize import root_scalar

    return root_scalar(function, bracket=(0.0, high), xtol=tolerance, rtol=1e-14).root


def _idle_drops(flow: float, area: float, circuit: Circuit) -> tuple[float, float, float, float]:
    """Pressure drops [Pa] from the tee to P, over the land P-T, of line 5 and of line 6."""
    to_p, drop_5, to_tank = _idle_lines(flow, circuit)
    a, b = resistance(area, land_orifice(circuit.parts.valve), circuit.parts.oil)
    return to_p, (a * abs(flow) + b) * flow, drop_5, to_tank


def _idle_lines(flow: float, circuit: Circuit) -> tuple[float, float, float]:
    """Pressure drops [Pa] from the tee to P, of line 5, and of line 6 to the tank."""
    parts = circuit.parts
    to_p = cracking_drop(parts.check) + fitting_resistance(flow, parts.fitting) * flow + line_drop(1, flow, circuit)
    to_tank = line_drop(5, flow, circuit) + steady_end(parts.return_end, flow, 0.0)
    return to_p, line_drop(4, flow, circuit), to_tank


def behind_check(tee: float, circuit: Circuit) -> float:
    """Pressure [Pa] at P while nothing flows there: what the check valve leaves of that at the tee."""
    return max(min(tee, 0.0), tee - cracking_drop(circuit.parts.check))


def line_drop(line: int, flow: float, circuit: Circuit) -> float:
    """Pressure drop [Pa] of a line at a steady flow [m^3/s], with what sits at its ends but for the fittings."""
    return steady_drop(circuit.lines, line, flow) + minor_drop(circuit.parts.losses, line, flow)


def equilibrium(circuit: Circuit, position: float, p_upper: float = 0.0) -> State:
    """The state at rest at a position [m]: p_u as given (0 after a stop with an open return), p_l carries the load.

    With a servo valve that lets oil through at rest and p_u 0, p_u is what that makes it. A load that pushes so hard in
    the positive direction that p_l would fall below the vapour pressure is carried by the upper chamber, the lower one
    at no pressure. Friction carries nothing. With a leak across the piston it is where the run starts, not where it
    stays; with a pump that ripples, what the mean of its flow would make. Raises ValueError outside the stroke.
    """
    cylinder = circuit.parts.cylinder
    if not 0.0 <= position <= cylinder.stroke:
        raise ValueError(f"start position {position} m lies outside the stroke, 0 to {cylinder.stroke} m")
    supply = supply_at_rest(circuit, starting_ratio(circuit.parts.supply))
    p, t, back = behind_check(supply.tee, circuit), 0.0, 0.0
    if supply.idle > 0.0:
        to_p, drop_5, back = _idle_lines(supply.idle, circuit)
        p, t = supply.tee - to_p, drop_5 + back
    laws = None if isinstance(circuit.parts.necks, Necks) else laws_at_rest(circuit)
    if laws and p_upper == 0.0:
        p_upper = upper_pressure(p, t, position, held_force(circuit.parts.load, position), laws, circuit) or 0.0
    p_lower, p_upper = holding_pressures(cylinder, circuit.parts.load, position, p_upper)
    p_a, p_b = _held_lines(Chambers(p_lower, p_upper), circuit)
    at = Pressures(supply.pump, supply.tee, p, p_a, p_lower, p_upper, p_b, t, back)
    through = Flows(supply.relieved + supply.idle, supply.idle, 0.0, 0.0, supply.idle, supply.idle)
    return state_at(at, through, Piston(position, 0.0), Spool(0.0, 0.0), circuit)


def _held_lines(p: Chambers, circuit: Circuit) -> Chambers:
    """Pressures [Pa] in the lines at rest: those of the chambers, but 0 before a valve that holds its chamber."""
    necks, oil = circuit.parts.necks, circuit.parts.oil
    if not isinstance(necks, Necks):
        return p
    sides = ((necks.accessory_a, p.lower), (necks.accessory_b, p.upper))
    tight = [steady_flow(-held, resting_neck(kind, 0.0, held, 0.0, oil)) == 0.0 for kind, held in sides]
    return Chambers(*(0.0 if shut else held for shut, held in zip(tight, p, strict=True)))


def holding_pressures(actuator: Actuator, load: AnyLoad, position: float, p_upper: float) -> Chambers:
    """Pressures [Pa] that carry a load at a position [m], as `equilibrium` says."""
    area, weight = interpreted(areas)(actuator, position), held_force(load, position)
    p_lower = (weight + area.upper * p_upper) / area.lower
    if p_lower < actuator.vapour_pressure:
        return Chambers(0.0, -weight / area.upper)
    return Chambers(p_lower, p_upper)


def relieved_at(tee: float, circuit: Circuit) -> tuple[float, float]:
    """Flow [m^3/s] over the relief valve at a pressure [Pa] at the tee, and the pressure before the valve."""
    valve, relief = circuit.parts.relief, lambda p: steady_relief(valve, p)
    most = relief(tee)
    if isinstance(circuit.parts.relief_place, AtTee) or most <= 0.0:
        return most, tee

    def excess(flow: float) -> float:
        return flow - relief(tee - steady_drop(circuit.lines, OWN_LINE, flow))

    flow = _root(excess, most, 1e-18) if excess(most) > 0.0 else most
    return flow, tee - steady_drop(circuit.lines, OWN_LINE, flow)


def state_at(p: Pressures, q: Flows, piston: Piston, spool: Spool, circuit: Circuit) -> State:
    """The state in which these pressures [Pa] and flows [m^3/s] have been steady; no cavities."""
    parts, lines = circuit.parts, circuit.lines
    at, relieved = dict(zip(PLACES, p, strict=True)), q.line_1 - q.line_2
    line_sides = _line_sides(p, q, circuit)
    pressure = np.array([(at | line_sides).get(end, 0.0) for end in ENDS])
    pressure[TEE_2] -= fitting_resistance(q.line_2, parts.fitting) * q.line_2
    pressure[TEE_2] -= cracking_drop(parts.check) if q.line_2 > 0.0 else p.tee - p.p if is_check(parts.check) else 0.0
    pressure[TANK] = steady_end(parts.return_end, q.line_6, p.back)
    memory, through, before = np.zeros(memory_size(lines)), np.array(q), p.tee
    if len(lines.model) > LINES:
        before = relieved_at(p.tee, circuit)[1]
        pressure, through = np.append(pressure, [p.tee, before]), np.append(through, relieved)
    flow = np.repeat(through, 2) * np.tile([1.0, -1.0], len(through))
    lost = np.repeat([loss_at_end(parts.losses, line) if line < LINES else 0.0 for line in range(len(through))], 2)
    inner = pressure - lost * np.abs(flow) * flow
    settle(lines, memory, inner, through)
    oil = lines.settled_capacity * inner.reshape(-1, 2).mean(axis=1)
    pressure[[LOWER, UPPER]] = p.lower, p.upper
    cavity, free, impedance = np.zeros((3, END_COUNT))
    ends = Ends(_padded(pressure), _padded(flow), cavity, free, impedance, np.resize(_padded(oil), END_COUNT // 2))
    signals = np.tile([piston.position, *(at[place] for place in TAPS.values())], 2)
    slots = Slots(*map(np.zeros, SLOT_SIZES))
    drop = Lands(p.p - p.a, p.b - p.t, p.p - p.b, p.a - p.t, p.p - p.t)
    begin_valve(parts.valve, spool, steady_lands(drop, spool.position, circuit), drop, slots.valve)
    if isinstance(parts.necks, Necks):
        _begin_necks(parts.necks, p, q, line_sides, slots)
    stored = interpreted(stored_oil)(Chambers(p.lower, p.upper), piston.position, parts.cylinder)
    begin_supply(parts.supply, p.pump, slots.supply)
    begin_accumulator(parts.p_accumulator, p.p, -q.line_2, slots.accumulator)
    at_tee = isinstance(parts.relief_place, AtTee)
    begin_accumulator(parts.tee_accumulator, p.tee, -relieved if at_tee else 0.0, slots.accumulator)
    relief = begin_relief(parts.relief, before, relieved, slots.relief)
    weight = weight_at(piston.position, parts.load) if isinstance(parts.load, Load) else Weight(0.0, 0.0, 0.0)
    begin_load(parts.load, piston.position, slots.load)
    core = Core(0.0, piston, spool, weight, stored, relief, before, Ledger(0.0, 0.0, 0.0))
    return _with_tee(State(core, ends, signals, slots, memory), circuit)


def _line_sides(p: Pressures, q: Flows, circuit: Circuit) -> dict[str, float]:
    """Pressures [Pa] of the cylinder's lines at their ends before the accessories, if these keep them apart."""
    if not isinstance(circuit.parts.necks, Necks):
        return {}
    return {"lower": p.a - line_drop(2, q.line_3, circuit), "upper": p.b - line_drop(3, q.line_4, circuit)}


def _begin_necks(necks: Necks, p: Pressures, q: Flows, line_sides: dict[str, float], slots: Slots) -> None:
    a, b, line_a, line_b = slots.accessory_a, slots.accessory_b, line_sides["lower"], line_sides["upper"]
    begin_accessory(necks.accessory_a, line_a, p.lower, line_b, a)
    begin_accessory(necks.accessory_b, line_b, p.upper, line_a, b)
    a[[INFLOW, LINE]], b[[INFLOW, LINE]] = (q.line_3, line_a), (q.line_4, line_b)


def _padded(at_ends: np.ndarray) -> np.ndarray:
    """The same for all ends, those of lines that are not fitted at zero."""
    return np.pad(at_ends, (0, END_COUNT - len(at_ends)))


def _with_tee(state: State, circuit: Circuit) -> State:
    """What the relief valve has met: its port at this instant."""
    free, impedance = np.zeros((2, END_COUNT))
    arriving(circuit.lines, state.memory.copy(), 1, free, impedance)
    if isinstance(circuit.parts.relief_place, OwnLine):
        return state.with_core(tee=float(free[VALVE_END]))
    resist(circuit.parts.losses, state.ends.flow, impedance)
    series = fitting_resistance(state.ends.flow[TEE_2], circuit.parts.fitting)
    port = joined(free[TEE_1], impedance[TEE_1], free[TEE_2], impedance[TEE_2] + series)
    return state.with_core(tee=port.free)
