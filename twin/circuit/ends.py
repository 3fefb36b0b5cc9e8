"""The line ends of a circuit, what the kinds in its slots keep, and how a component meets an end."""

from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.kernel import inlined
from twin.port import Port, cavity, pressure, with_cavity
from twin.topology import ENDS, RELIEF_END

PUMP, TEE_1, TEE_2, P, A, LOWER, B, UPPER, T, BACK_5, BACK_6, TANK = range(len(ENDS))
VALVE_END = RELIEF_END + 1


class Ends(NamedTuple):
    """The line ends at the last instant, in the order of ENDS, and the oil of the lines; the relief line's own last.

    Pressures at LOWER and UPPER are those of the chambers; that of a line that ends before an accessory is in its slot.
    """

    pressure: NDArray  # [Pa]
    flow: NDArray  # into the line [m^3/s]
    cavity: NDArray  # [m^3]; of a tee at its first end, behind the fittings at TEE_2, inside a chamber not here
    free: NDArray  # c [Pa]
    impedance: NDArray  # Z [Pa s/m^3]
    oil: NDArray  # in each line, beyond what fills it at no pressure [m^3 at reference density]


class Slots(NamedTuple):
    """What the kinds in the slots keep, in the order of SLOTS: SLOT_SIZES numbers each."""

    supply: NDArray
    accumulator: NDArray
    fittings: NDArray
    relief: NDArray
    return_end: NDArray
    valve: NDArray
    accessory_a: NDArray
    accessory_b: NDArray
    cushion: NDArray
    actuator: NDArray
    friction: NDArray
    load: NDArray


@inlined
def port_at(end: int, ends: Ends, step: float) -> Port:
    """The port of one line end, its cavity included."""
    return with_cavity(Port(ends.free[end], ends.impedance[end]), ends.cavity[end], step)


@inlined
def set_pressure(end: int, p: float, ends: Ends) -> None:
    """A line end takes a pressure."""
    ends.pressure[end] = p
    ends.flow[end] = (p - ends.free[end]) / ends.impedance[end]


@inlined
def deliver(end: int, port: Port, flow: float, ends: Ends, parts: Any) -> float:
    """One line end takes what a component delivers; returns the pressure."""
    p = pressure(port, flow, parts.oil.vapour_pressure)
    ends.cavity[end] = cavity(port, flow, p, parts.step) if p == parts.oil.vapour_pressure else 0.0
    set_pressure(end, p, ends)
    return p
