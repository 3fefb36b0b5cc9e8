"""Where a run starts: valve at rest, load held by the lower chamber, pump over relief valve or tandem centre."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from twin.circuit.state import Flows, Pressures, State
from twin.circuit.step import (
    TEE_1,
    TEE_2,
    Circuit,
    Core,
    Ends,
    Ledger,
    Piston,
    Spool,
    land_areas,
)
from twin.cylinder import Chambers, stored_oil
from twin.fitting import fitting_resistance
from twin.lines.bank import arriving, memory_size, settle, steady_drop
from twin.load import carried_mass, weight_at
from twin.minor_losses import loss_at_end, minor_drop, resist
from twin.orifice import resistance
from twin.port import joined
from twin.pump import pumped_oil, speed_ratio
from twin.relief.motion import begin
from twin.relief.steady import rest, steady_flow
from twin.topology import ENDS, LINES, PLACES, TAPS

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
        relieved = steady_flow(tee, circuit.parts.relief) if circuit.parts.fitted.relief else 0.0
        idle = idle_flow(tee, circuit)
        pump = tee + _line_drop(0, relieved + idle, circuit)
        delivered = pumped_oil(pump, ratio, circuit.parts.pump, circuit.parts.oil.bulk_modulus)[0]
        return SupplyAtRest(pump, tee, relieved, idle), delivered - relieved - idle

    if at(0.0)[1] <= TIGHT:  # pump off: any pressure below cracking stays
        return at(0.0)[0]
    high = 1e5
    while at(high)[1] > 0.0:
        high *= 2.0
        if high > HIGHEST:
            raise ValueError(
                "the pump flow has no outlet: no relief valve, a shut valve and no leakage; "
                "take relief.kind = 'two-stage', a tandem centre or pump.efficiency below 1"
            )
    return at(_root(lambda tee: at(tee)[1], high, 1e-6))[0]


def idle_flow(tee: float, circuit: Circuit) -> float:
    """Flow [m^3/s] from the tee through the valve at rest to the tank, at a pressure [Pa] at the tee."""
    area = land_areas(0.0, circuit.parts).p_t
    if area <= 0.0 or tee <= 0.0:
        return 0.0

    def excess(flow: float) -> float:
        return tee - sum(_idle_drops(flow, area, circuit))

    high = 1e-6
    while excess(high) > 0.0:
        high *= 2.0
    return _root(excess, high, 1e-18)


def _root(function: Callable[[float], float], high: float, tolerance: float) -> float:
    """Where a function changes its sign between 0 and `high`."""
    from scipy.optimize import root_scalar

    return root_scalar(function, bracket=(0.0, high), xtol=tolerance, rtol=1e-14).root


def _idle_drops(flow: float, area: float, circuit: Circuit) -> tuple[float, float, float, float]:
    """Pressure drops [Pa] from the tee to P, over the land P-T, of line 5 and of line 6."""
    parts = circuit.parts
    a, b = resistance(area, parts.switching.orifice, parts.oil)
    to_p = fitting_resistance(flow, parts.fitting) * flow + _line_drop(1, flow, circuit)
    return to_p, (a * abs(flow) + b) * flow, _line_drop(4, flow, circuit), _line_drop(5, flow, circuit)


def _line_drop(line: int, flow: float, circuit: Circuit) -> float:
    """Pressure drop [Pa] of a line at a steady flow [m^3/s], with what sits at its ends but for the fittings."""
    return steady_drop(circuit.lines, line, flow) + minor_drop(circuit.parts.losses, line, flow)


def equilibrium(circuit: Circuit, position: float, p_upper: float = 0.0) -> State:
    """The state at rest at a position [m]: p_u as given (0 after a stop with an open return), p_l carries the load.

    With a leak across the piston it is where the run starts, not where it stays; with a pump that ripples, what the
    mean of its flow would make. Raises ValueError outside the stroke, or for a load that would need a lower chamber
    below the vapour pressure.
    """
    cylinder, load, vapour = circuit.parts.cylinder, circuit.parts.load, circuit.parts.oil.vapour_pressure
    if not 0.0 <= position <= cylinder.stroke:
        raise ValueError(f"start position {position} m lies outside the stroke, 0 to {cylinder.stroke} m")
    weight = carried_mass(weight_at(position, load), load) * load.gravity - load.force
    p_lower = (weight + cylinder.area_upper * p_upper) / cylinder.area_lower
    if p_lower < vapour:
        most = load.force + weight + cylinder.area_upper * p_upper - cylinder.area_lower * vapour
        raise ValueError(
            f"load.force {load.force:g} N lifts the load off the oil, the lower chamber would be at {p_lower:.4g} Pa, "
            f"below the vapour pressure; take at most {most:.4g} N"
        )
    supply = supply_at_rest(circuit, speed_ratio(0.0, circuit.parts.pump))
    p, t, back = supply.tee, 0.0, 0.0
    if supply.idle > 0.0:
        to_p, _, drop_5, back = _idle_drops(supply.idle, land_areas(0.0, circuit.parts).p_t, circuit)
        p, t = supply.tee - to_p, drop_5 + back
    at = Pressures(supply.pump, supply.tee, p, p_lower, p_lower, p_upper, p_upper, t, back)
    through = Flows(supply.relieved + supply.idle, supply.idle, 0.0, 0.0, supply.idle, supply.idle)
    return state_at(at, through, Piston(position, 0.0), Spool(0.0, 0.0), circuit)


def state_at(p: Pressures, q: Flows, piston: Piston, spool: Spool, circuit: Circuit) -> State:
    """The state in which these pressures [Pa] and flows [m^3/s] have been steady; no cavities."""
    parts, lines = circuit.parts, circuit.lines
    at = dict(zip(PLACES, p, strict=True))
    pressure = np.array([at.get(end, 0.0) for end in ENDS])
    pressure[TEE_2] -= fitting_resistance(q.line_2, parts.fitting) * q.line_2
    memory, through = np.zeros(memory_size(lines)), np.array(q)
    flow = np.repeat(through, 2) * np.tile([1.0, -1.0], LINES)
    lost = np.repeat([loss_at_end(parts.losses, line) for line in range(LINES)], 2)
    inner = pressure - lost * np.abs(flow) * flow
    settle(lines, memory, inner, through)
    cavity, free, impedance = np.zeros((3, len(ENDS)))
    ends = Ends(pressure, flow, cavity, free, impedance, _line_oil(inner, circuit))
    signals = np.tile([piston.position, *(at[place] for place in TAPS.values())], 2)
    core = _core(p, q.line_1 - q.line_2, piston, spool, circuit)
    return _with_tee(State(core, ends, signals, memory), circuit)


def _line_oil(pressure: np.ndarray, circuit: Circuit) -> np.ndarray:
    return circuit.lines.capacity * pressure.reshape(LINES, 2).mean(axis=1)


def _core(p: Pressures, relieved: float, piston: Piston, spool: Spool, circuit: Circuit) -> Core:
    parts = circuit.parts
    stored = stored_oil(Chambers(p.lower, p.upper), piston.position, parts.cylinder)
    weight = weight_at(piston.position, parts.load)
    relief = begin(rest(p.tee, parts.relief), p.tee, relieved, parts.relief)
    return Core(0.0, piston, spool, weight, stored, relief, p.tee, Ledger(0.0, 0.0, 0.0))


def _with_tee(state: State, circuit: Circuit) -> State:
    """What the relief valve has met: the port of the tee at this instant."""
    free, impedance = np.zeros((2, len(ENDS)))
    arriving(circuit.lines, state.memory.copy(), 1, free, impedance)
    resist(circuit.parts.losses, state.ends.flow, impedance)
    series = fitting_resistance(state.ends.flow[TEE_2], circuit.parts.fitting)
    port = joined(free[TEE_1], impedance[TEE_1], free[TEE_2], impedance[TEE_2] + series)
    return state.with_core(tee=port.free)
