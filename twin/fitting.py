"""Losses of what sits in a pipe and does nothing else: filter, two-position valve. dp = b Q + a Q|Q|."""

from typing import NamedTuple

from twin.kernel import inlined


class Fitting(NamedTuple):
    """Elements in series, added up."""

    linear: float  # b [Pa s/m^3]
    quadratic: float  # a [Pa s^2/m^6]


@inlined
def fitting_resistance(flow: float, fitting: Fitting) -> float:
    """Pressure drop over flow [Pa s/m^3] at a flow [m^3/s]."""
    return fitting.linear + fitting.quadratic * abs(flow)


@inlined
def fitting_slope(flow: float, fitting: Fitting) -> float:
    """Slope of the pressure drop by the flow [Pa s/m^3]."""
    return fitting.linear + 2.0 * fitting.quadratic * abs(flow)
