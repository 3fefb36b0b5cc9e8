"""The lands of a directional valve: how much each is open, and what flows through them between four ports."""

import math
from typing import NamedTuple

from twin.kernel import inlined
from twin.oil import Oil
from twin.orifice import LEAST_AREA, Orifice, resistance
from twin.port import Port, passage, pressure

MOST_ITERATIONS = 60
SMALLEST_REACH = 1e-7  # [m^3/s]
TIGHT = 1e-2  # [Pa]


class Lands(NamedTuple):
    """A value for each land: areas [m^2], or flows [m^3/s] in the direction of the name."""

    p_a: float
    b_t: float
    p_b: float
    a_t: float
    p_t: float


class Ports(NamedTuple):
    """The four ports."""

    p: Port
    a: Port
    b: Port
    t: Port


@inlined
def _flow(source: Port, sink: Port, area: float, orifice: Orifice, oil: Oil) -> float:
    if area <= LEAST_AREA:
        return 0.0
    a, b = resistance(area, orifice, oil)
    return passage(source, sink, a, b, oil.vapour_pressure)


@inlined
def _shifted(port: Port, flow: float) -> Port:
    """A port into which some flow goes already."""
    return Port(port.free + port.impedance * flow, port.impedance)


@inlined
def _to_cylinder(ports: Ports, area: Lands, p_t: float, orifice: Orifice, oil: Oil) -> Lands:
    """Flows with the cylinder while a flow goes from P to T. Of a pair that shares a port one land at most is open."""
    p, t = _shifted(ports.p, -p_t), _shifted(ports.t, p_t)
    return Lands(
        _flow(p, ports.a, area.p_a, orifice, oil),
        _flow(ports.b, t, area.b_t, orifice, oil),
        _flow(p, ports.b, area.p_b, orifice, oil),
        _flow(ports.a, t, area.a_t, orifice, oil),
        p_t,
    )


@inlined
def flows_apart(ports: Ports, area: Lands, orifice: Orifice, oil: Oil) -> Lands:
    """Flows where each port has one open land at most and P-T is shut, in closed form."""
    return _to_cylinder(ports, area, 0.0, orifice, oil)


@inlined
def land_flows(ports: Ports, area: Lands, orifice: Orifice, oil: Oil) -> Lands:
    """Flows through all lands. In closed form, but where P-T is open beside others: there one unknown is bracketed."""
    if area.p_t <= 0.0:
        return _to_cylinder(ports, area, 0.0, orifice, oil)
    alone = _flow(ports.p, ports.t, area.p_t, orifice, oil)
    if area.p_a <= 0.0 and area.p_b <= 0.0:
        return Lands(0.0, 0.0, 0.0, 0.0, alone)
    return _to_cylinder(ports, area, _p_to_t(alone, ports, area, orifice, oil), orifice, oil)


@inlined
def _excess(p_t: float, ports: Ports, area: Lands, orifice: Orifice, oil: Oil) -> float:
    """Pressure drop from P to T beyond what the land P-T takes at a flow: falls steadily with it."""
    flows = _to_cylinder(ports, area, p_t, orifice, oil)
    p = pressure(ports.p, -(p_t + flows.p_a + flows.p_b), oil.vapour_pressure)
    t = pressure(ports.t, p_t + flows.b_t + flows.a_t, oil.vapour_pressure)
    a, b = resistance(area.p_t, orifice, oil)
    return p - t - (a * abs(p_t) + b) * p_t


@inlined
def _p_to_t(guess: float, ports: Ports, area: Lands, orifice: Orifice, oil: Oil) -> float:
    """The flow from P to T that leaves no excess: bracketed, then regula falsi (Illinois)."""
    low, at_low = guess, _excess(guess, ports, area, orifice, oil)
    reach = math.copysign(0.25 * abs(guess) + SMALLEST_REACH, at_low)
    high, at_high = guess, at_low
    while at_low * at_high > 0.0:
        low, at_low = high, at_high
        high += reach
        at_high = _excess(high, ports, area, orifice, oil)
        reach *= 2.0
    for _ in range(MOST_ITERATIONS):
        if abs(at_high) <= TIGHT or at_low == at_high:
            break
        q = (low * at_high - high * at_low) / (at_high - at_low)
        at = _excess(q, ports, area, orifice, oil)
        if at * at_high < 0.0:
            low, at_low = high, at_high
        else:
            at_low *= 0.5
        high, at_high = q, at
    return high
