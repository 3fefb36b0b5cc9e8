"""Where a run starts: valve shut, load held by the lower chamber, pump running over the relief valve, nothing moves."""

from twin.circuit import Circuit, Flows, Ledger, Piston, Pressures, Spool, State, Stored, nodes
from twin.lines.lumped import line_resistance
from twin.pump import pumped_oil
from twin.relief import relief_flow, relief_slope


def supply_at_rest(circuit: Circuit) -> tuple[float, float, float]:
    """Pressures at the pump and at the relief tee [Pa] and the flow between them [m^3/s], the valve shut."""
    line = circuit.line_1
    tee = circuit.relief.knee
    for _ in range(50):
        flow = relief_flow(tee, circuit.relief)
        outlet = tee + line_resistance(flow, line) * flow
        inflow, slope = pumped_oil(outlet, circuit.pump, circuit.oil.bulk_modulus)
        gain = relief_slope(tee, circuit.relief)
        excess_slope = gain - slope * (1.0 + line_resistance(flow, line) * gain)
        if excess_slope == 0.0:  # pump off and tight: any pressure below cracking stays
            break
        tee -= (flow - inflow) / excess_slope
    flow = relief_flow(tee, circuit.relief)
    return tee + line_resistance(flow, line) * flow, tee, flow


def equilibrium(circuit: Circuit, position: float, p_upper: float = 0.0) -> State:
    """The state at rest at a position [m]: p_u as given (0 after a stop with an open return), p_l carries the load.

    With a leak across the piston it is where the run starts, not where it stays. Raises ValueError outside the
    stroke, or for a load that would need a lower chamber below the vapour pressure.
    """
    cylinder, load = circuit.cylinder, circuit.load
    if not 0.0 <= position <= cylinder.stroke:
        raise ValueError(f"start position {position} m lies outside the stroke, 0 to {cylinder.stroke} m")
    weight = load.mass * load.gravity - load.force
    p_lower = (weight + cylinder.area_upper * p_upper) / cylinder.area_lower
    if p_lower < circuit.oil.vapour_pressure:
        raise ValueError(f"load.force {load.force} N lifts the load off the oil: p_lower would be {p_lower} Pa")
    p_pump, p_tee, flow = supply_at_rest(circuit)
    p = Pressures(p_pump, p_tee, p_tee, p_lower, p_lower, p_upper, p_upper, 0.0, 0.0)
    flows = Flows(flow, 0.0, 0.0, 0.0, 0.0, 0.0)
    return State(fill(p, position, circuit), flows, Piston(position, 0.0), Spool(0.0, 0.0), Ledger(0.0, 0.0, 0.0))


def fill(p: Pressures, position: float, circuit: Circuit) -> Stored:
    """The oil that makes these pressures, none below the vapour pressure, with the piston at a position [m]."""
    at = nodes(Stored(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), position, circuit)
    return Stored(*(node.volume + node.capacity * pressure for node, pressure in zip(at, p, strict=True)))
