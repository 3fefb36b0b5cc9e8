"""What a component meets at a line end: a pressure that gives way with the flow, and never falls below the vapour
pressure.

A line offers p = c + Z q, q the flow into it; c and Z come from its past alone. Several ends at one place are one
port. Where p would fall below the vapour pressure it stays there, and the oil leaves a cavity behind: a discrete
vapour cavity with its volume V as a state,

    V' = (flow into the lines) - (flow from the component),   V >= 0,   p >= p_v,   V (p - p_v) = 0,

taken implicitly over the step. So V is folded into the port: p = max(p_v, c - Z V/h + Z Q).
"""

from typing import NamedTuple

from twin.kernel import inlined
from twin.orifice import quadratic_flow


class Port(NamedTuple):
    """p = max(p_v, free + impedance * Q), Q the flow a component delivers into the lines."""

    free: float  # [Pa], at no flow
    impedance: float  # [Pa s/m^3]


@inlined
def joined(c_1: float, z_1: float, c_2: float, z_2: float) -> Port:
    """Two line ends at one place, (2.101): one pressure, flows add up."""
    impedance = z_1 * z_2 / (z_1 + z_2)
    return Port(impedance * (c_1 / z_1 + c_2 / z_2), impedance)


@inlined
def with_cavity(port: Port, volume: float, step: float) -> Port:
    """The port as a component meets it that must first fill a cavity [m^3] within the step [s]."""
    return Port(port.free - port.impedance * volume / step, port.impedance)


@inlined
def pressure(port: Port, flow: float, vapour_pressure: float) -> float:
    """p [Pa] when a component delivers a flow [m^3/s]."""
    return max(vapour_pressure, port.free + port.impedance * flow)


@inlined
def cavity(port: Port, flow: float, vapour_pressure: float, step: float) -> float:
    """Volume of the cavity [m^3] after the step."""
    return max(0.0, step * ((vapour_pressure - port.free) / port.impedance - flow))


@inlined
def passage(source: Port, sink: Port, a: float, b: float, vapour_pressure: float) -> float:
    """Q [m^3/s] from source to sink with a Q|Q| + b Q = p_source - p_sink.

    The left side rises and the right side falls with Q, so there is one answer. Oil never runs towards the higher
    pressure, hence only the receiving end can still be a cavity when oil flows.
    """
    q = quadratic_flow(source.free - sink.free, a, b + source.impedance + sink.impedance)
    if source.free - source.impedance * q >= vapour_pressure and sink.free + sink.impedance * q >= vapour_pressure:
        return q
    if source.free > vapour_pressure:
        return quadratic_flow(source.free - vapour_pressure, a, b + source.impedance)
    if sink.free > vapour_pressure:
        return quadratic_flow(vapour_pressure - sink.free, a, b + sink.impedance)
    return 0.0
