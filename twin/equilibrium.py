"""Where a run starts: valve shut, load held by the lower chamber, pump running over the relief valve, nothing moves."""

from twin.circuit import Circuit, Flows, Ledger, Piston, Spool, State, Stored
from twin.cylinder import chamber_volumes
from twin.lines.lumped import LumpedLine, line_resistance
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
        tee -= (flow - inflow) / (gain - slope * (1.0 + line_resistance(flow, line) * gain))
        if tee <= circuit.relief.cracking and inflow <= 0.0:
            break
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
    v_lower, v_upper = chamber_volumes(position, cylinder)
    modulus = circuit.oil.bulk_modulus

    def ends(p: float, *lines: LumpedLine) -> float:
        return sum(line.end_volume + line.end_capacity * p for line in lines)

    oil = Stored(
        pump=ends(p_pump, circuit.line_1),
        tee=ends(p_tee, circuit.line_1, circuit.line_2),
        p=ends(p_tee, circuit.line_2),
        a=ends(p_lower, circuit.line_3),
        lower=ends(p_lower, circuit.line_3) + v_lower * (1.0 + p_lower / modulus),
        upper=ends(p_upper, circuit.line_4) + v_upper * (1.0 + p_upper / modulus),
        b=ends(p_upper, circuit.line_4),
        t=ends(0.0, circuit.line_5),
        back=ends(0.0, circuit.line_5, circuit.line_6),
    )
    return State(
        oil, Flows(flow, 0.0, 0.0, 0.0, 0.0, 0.0), Piston(position, 0.0), Spool(0.0, 0.0), Ledger(0.0, 0.0, 0.0)
    )
