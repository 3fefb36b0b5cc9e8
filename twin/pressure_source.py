"""Constant pressure behind a resistance, Q = (p_s - p)/R in both directions: a ring main, or a large pump station.

Q is oil at reference density. The source gives energy and takes it back; the resistance only takes.
"""

from typing import NamedTuple

from twin.kernel import inlined
from twin.oil import Oil
from twin.port import Port


class PressureSource(NamedTuple):
    """A source that is there at once, or comes up at a constant rate."""

    pressure: float  # p_s [Pa]
    resistance: float  # R [Pa s/m^3]
    run_up: float  # from no pressure at time 0 [s]; 0.0: it is there


@inlined
def sourced(port: Port, ratio: float, source: PressureSource, oil: Oil) -> float:
    """Oil delivered [m^3/s] against a port, at a ratio of the full pressure."""
    pressure = source.pressure * ratio
    q = (pressure - port.free) / (port.impedance + source.resistance)
    if port.free + port.impedance * q >= oil.vapour_pressure:
        return q
    return (pressure - oil.vapour_pressure) / source.resistance
