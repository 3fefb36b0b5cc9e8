"""An actuator whose chambers lie behind necks: accessories in its ports, cushions at its ends.

As `actuator.fill_chambers`, by the trapezoidal rule: with the oil that a chamber has anyway after the step its pressure
is a port of the impedance h B/(2 V), so the flow through its neck is one unknown; with air in the oil B is that of the
last pressure. The leaks follow with these flows, implicitly: a step of any length damps them.
"""

from typing import Any

from twin.actuator import chamber_pressures, moduli, outside, passed, volumes
from twin.air import tangent
from twin.cylinder import Chambers
from twin.kernel import inlined
from twin.neck import Neck, neck_flow
from twin.oil import Oil
from twin.port import Port


@inlined
def chamber_port(oil_then: float, held: tuple[float, float], half: float) -> Port:
    """The chamber as a neck meets it; oil_then: what it has after the step without the neck's flow [m^3]."""
    capacity, empty = held
    return Port((oil_then - empty) / capacity, half / capacity)


@inlined
def fill_behind_necks(
    stored: Chambers, p: Chambers, inflow: Chambers, lower: tuple[Port, Neck], upper: tuple[Port, Neck],
    position: float, actuator: Any, oil: Oil, step: float,
) -> tuple[Chambers, Chambers, Chambers, float]:  # fmt: skip
    """Stored oil, pressures and flows into the chambers a step [s] later, the piston then at a position [m], and oil
    lost to the outside [m^3].

    p, inflow: pressures and flows at the start; lower, upper: port of the line and neck of each chamber.
    """
    half, volume, gone, b = 0.5 * step, volumes(actuator, position), passed(actuator, position), moduli(actuator)
    leak, out = actuator.leakage * (p.lower - p.upper), outside(actuator, p)
    out_l, out_u = out.lower * p.lower, out.upper * p.upper
    s_l, s_u = stored.lower + half * (inflow.lower - leak - out_l), stored.upper + half * (inflow.upper + leak - out_u)
    held_l, held_u = (
        tangent(actuator.air, b.lower, volume.lower, p.lower),
        tangent(actuator.air, b.upper, volume.upper, p.upper),
    )
    port_l = chamber_port(s_l - half * (leak + out_l) - gone.lower, held_l, half)
    port_u = chamber_port(s_u + half * (leak - out_u) - gone.upper, held_u, half)
    q_l, q_u = neck_flow(lower[0], port_l, lower[1], oil), neck_flow(upper[0], port_u, upper[1], oil)
    s_l, s_u = s_l + half * q_l, s_u + half * q_u
    tight = chamber_pressures(Chambers(s_l, s_u), position, actuator)
    lost_l = out.lower * tight.lower / (1.0 + out.lower * port_l.impedance)
    lost_u = out.upper * tight.upper / (1.0 + out.upper * port_u.impedance)
    stiffness = actuator.leakage * (port_l.impedance + port_u.impedance)
    leak = actuator.leakage * (tight.lower - tight.upper) / (1.0 + stiffness)
    then = Chambers(s_l - half * (leak + lost_l), s_u + half * (leak - lost_u))
    lost = half * (out_l + out_u + lost_l + lost_u)
    return then, chamber_pressures(then, position, actuator), Chambers(q_l, q_u), lost
