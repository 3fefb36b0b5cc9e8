"""A cylinder whose chambers lie behind necks: accessories in its ports, cushions at its ends.

As `cylinder.fill_chambers`, by the trapezoidal rule: with the oil that a chamber has anyway after the step its pressure
is a port of the impedance h B/(2 V), so the flow through its neck is one unknown. The leak across the piston follows
with these flows, implicitly: a step of any length damps it.
"""

from twin.cylinder import Chambers, Cylinder, chamber_pressures, chamber_volumes
from twin.kernel import inlined
from twin.neck import Neck, neck_flow
from twin.oil import Oil
from twin.port import Port


@inlined
def chamber_port(oil_then: float, volume: float, half: float, cylinder: Cylinder) -> Port:
    """The chamber as a neck meets it; oil_then: what it has after the step without the neck's flow [m^3]."""
    return Port(cylinder.bulk_modulus * (oil_then / volume - 1.0), cylinder.bulk_modulus * half / volume)


@inlined
def fill_behind_necks(
    stored: Chambers, p: Chambers, inflow: Chambers, lower: tuple[Port, Neck], upper: tuple[Port, Neck],
    position: float, cylinder: Cylinder, oil: Oil, step: float,
) -> tuple[Chambers, Chambers, Chambers]:  # fmt: skip
    """Stored oil, pressures and flows into the chambers a step [s] later, the piston then at a position [m].

    p, inflow: pressures and flows at the start; lower, upper: port of the line and neck of each chamber.
    """
    half, volume = 0.5 * step, chamber_volumes(position, cylinder)
    leak = cylinder.leakage * (p.lower - p.upper)
    s_l, s_u = stored.lower + half * (inflow.lower - leak), stored.upper + half * (inflow.upper + leak)
    port_l = chamber_port(s_l - half * leak, volume.lower, half, cylinder)
    port_u = chamber_port(s_u + half * leak, volume.upper, half, cylinder)
    q_l, q_u = neck_flow(lower[0], port_l, lower[1], oil), neck_flow(upper[0], port_u, upper[1], oil)
    s_l, s_u = s_l + half * q_l, s_u + half * q_u
    tight = chamber_pressures(Chambers(s_l, s_u), position, cylinder)
    stiffness = cylinder.leakage * (port_l.impedance + port_u.impedance)
    leak = cylinder.leakage * (tight.lower - tight.upper) / (1.0 + stiffness)
    then = Chambers(s_l - half * leak, s_u + half * leak)
    return then, chamber_pressures(then, position, cylinder), Chambers(q_l, q_u)
