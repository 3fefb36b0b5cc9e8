"""The circuit as one ordinary differential equation, stated once: what `circuit` integrates, without its time steps.

Left out is what has no rate: end stops, the limits of the spool, and the set-valued seal friction, in whose place a
viscous slope may stand. Any integrator of the reader's choice can check the scheme in `circuit` against it.
"""

from twin.circuit import Circuit, Flows, Ledger, Piston, Pressures, Spool, State, Stored, pressures
from twin.cylinder import drive
from twin.kernel import kernel
from twin.lines.lumped import LumpedLine, line_resistance
from twin.orifice import flow
from twin.pump import pumped_oil
from twin.relief import relief_flow
from twin.spool_valve import opening


@kernel
def rates(s: State, reference: float, c: Circuit, viscous: float = 0.0) -> State:
    """Time derivative of every part of a state under a spool reference; viscous: friction over speed [N s/m]."""
    p = pressures(s, c)
    oil, ledger = oil_rates(s, p, c)
    spring, damping = c.valve.natural_frequency**2, 2.0 * c.valve.damping * c.valve.natural_frequency
    v = s.piston.velocity
    return State(
        oil,
        flow_rates(s.flows, p, c),
        Piston(v, (drive(p.lower, p.upper, c.cylinder, c.load) - viscous * v) / c.load.mass),
        Spool(s.spool.velocity, spring * (reference - s.spool.position) - damping * s.spool.velocity),
        ledger,
    )


@kernel
def flow_rate(q: float, drop: float, line: LumpedLine) -> float:
    """Rate of a line's flow [m^3/s^2] under a pressure drop [Pa]."""
    return (drop - line_resistance(q, line) * q) / line.inertance


@kernel
def flow_rates(q: Flows, p: Pressures, c: Circuit) -> Flows:
    """Rates of the line flows [m^3/s^2]."""
    return Flows(
        flow_rate(q.line_1, p.pump - p.tee, c.line_1),
        flow_rate(q.line_2, p.tee - p.p, c.line_2),
        flow_rate(q.line_3, p.a - p.lower, c.line_3),
        flow_rate(q.line_4, p.b - p.upper, c.line_4),
        flow_rate(q.line_5, p.t - p.back, c.line_5),
        flow_rate(q.line_6, p.back, c.line_6),
    )


@kernel
def oil_rates(s: State, p: Pressures, c: Circuit) -> tuple[Stored, Ledger]:
    """Rates of the oil in the nodes and across the border [m^3/s]."""
    orifice, q = c.valve.orifice, s.flows
    up, down = opening(s.spool.position, c.valve), opening(-s.spool.position, c.valve)
    p_a, b_t = flow(p.p - p.a, up, orifice, c.oil), flow(p.b - p.t, up, orifice, c.oil)
    p_b, a_t = flow(p.p - p.b, down, orifice, c.oil), flow(p.a - p.t, down, orifice, c.oil)
    supply = pumped_oil(p.pump, c.pump, c.oil.bulk_modulus)[0]
    bypass = relief_flow(p.tee, c.relief)
    leak = (p.lower - p.upper) / c.cylinder.leakage_resistance
    oil = Stored(
        supply - q.line_1,
        q.line_1 - q.line_2 - bypass,
        q.line_2 - p_a - p_b,
        p_a - a_t - q.line_3,
        q.line_3 - leak,
        q.line_4 + leak,
        p_b - b_t - q.line_4,
        b_t + a_t - q.line_5,
        q.line_5 - q.line_6,
    )
    return oil, Ledger(supply, bypass, q.line_6)
