"""What line 6 ends in: the open tank, an orifice, or an orifice behind a back-pressure check valve.

    p = a Q|Q| + b Q,  Q to the tank;   with a check valve  Q >= 0,  p - a Q|Q| - b Q <= p_c,  one of both an equality

The tank is at 0. An orifice lets oil back in, a check valve does not. All of them only take energy.
"""

from typing import Any, NamedTuple

from twin.kernel import by_type
from twin.oil import Oil
from twin.orifice import quadratic_flow
from twin.port import Port, passage


class OpenEnd(NamedTuple):
    """The end of the line is at the pressure of the tank."""


class OrificeEnd(NamedTuple):
    """An orifice into the tank."""

    quadratic: float  # a [Pa s^2/m^6]
    linear: float  # b [Pa s/m^3]


class CheckedEnd(NamedTuple):
    """A check valve that opens towards the tank, with an orifice in series."""

    cracking_pressure: float  # p_c [Pa]
    quadratic: float  # a [Pa s^2/m^6]
    linear: float  # b [Pa s/m^3]


AnyEnd = OpenEnd | OrificeEnd | CheckedEnd


@by_type
def is_open_end(end: Any) -> bool:
    """Is the end of the line at the pressure of the tank?"""
    raise TypeError(f"{end} is not an end of the return line")


@is_open_end.register
def _(end: OpenEnd) -> bool:
    return True


@is_open_end.register
def _(end: OrificeEnd) -> bool:
    return False


@is_open_end.register
def _(end: CheckedEnd) -> bool:
    return False


@by_type
def return_flow(end: Any, port: Port, oil: Oil) -> float:
    """Q [m^3/s] into the line, so below 0 as a rule; port: of the line's end, its cavity folded in."""
    raise TypeError(f"{end} is not an end of the return line")


@return_flow.register
def _(end: OpenEnd, port: Port, oil: Oil) -> float:
    return -port.free / port.impedance


@return_flow.register
def _(end: OrificeEnd, port: Port, oil: Oil) -> float:
    return passage(Port(0.0, 0.0), port, end.quadratic, end.linear, oil.vapour_pressure)


@return_flow.register
def _(end: CheckedEnd, port: Port, oil: Oil) -> float:
    if port.free <= end.cracking_pressure:
        return 0.0
    return -quadratic_flow(port.free - end.cracking_pressure, end.quadratic, end.linear + port.impedance)


@by_type
def return_drop(end: Any, flow: float) -> float:
    """Pressure [Pa] at the line's end at a steady flow [m^3/s] to the tank, >= 0 with a check valve."""
    raise TypeError(f"{end} is not an end of the return line")


@return_drop.register
def _(end: OpenEnd, flow: float) -> float:
    return 0.0


@return_drop.register
def _(end: OrificeEnd, flow: float) -> float:
    return (end.quadratic * abs(flow) + end.linear) * flow


@return_drop.register
def _(end: CheckedEnd, flow: float) -> float:
    return end.cracking_pressure + (end.quadratic * abs(flow) + end.linear) * flow


@by_type
def return_slope(end: Any, flow: float) -> float:
    """Slope of that pressure by the flow [Pa s/m^3]."""
    raise TypeError(f"{end} is not an end of the return line")


@return_slope.register
def _(end: OpenEnd, flow: float) -> float:
    return 0.0


@return_slope.register
def _(end: OrificeEnd, flow: float) -> float:
    return 2.0 * end.quadratic * abs(flow) + end.linear


@return_slope.register
def _(end: CheckedEnd, flow: float) -> float:
    return 2.0 * end.quadratic * abs(flow) + end.linear


def steady_end(end: AnyEnd, flow: float, held: float) -> float:
    """Pressure [Pa] at the line's end at a steady flow [m^3/s] to the tank; held: in the line while nothing flows."""
    if isinstance(end, OpenEnd):
        return 0.0
    if isinstance(end, CheckedEnd) and flow <= 0.0:
        return min(held, end.cracking_pressure)
    return return_drop(end, flow)
