"""The slot of the relief valve, at the tee or at the end of a line of its own. Which kind is fitted is known when a
step is compiled."""

from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.kernel import by_type
from twin.port import Port
from twin.relief.motion import Motion, ReliefState, begin
from twin.relief.network import Relief
from twin.relief.steady import rest, steady_flow
from twin.relief.valve import step_valve


class NoRelief(NamedTuple):
    """There is no relief valve."""


AnyRelief = Relief | NoRelief
ABSENT = Motion(ReliefState(0.0, 0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@by_type
def move_relief(valve: Any, motion: Motion, before: float, port: Port, memory: NDArray, step: float) -> Motion:
    """The valve a step [s] later; its `flow` is what it takes from the port. before: port.free of the last instant."""
    raise TypeError(f"{valve} is not a relief valve")


@move_relief.register
def _(valve: Relief, motion: Motion, before: float, port: Port, memory: NDArray, step: float) -> Motion:
    return step_valve(motion, before, port.free, port.impedance, valve, step)[0]


@move_relief.register
def _(valve: NoRelief, motion: Motion, before: float, port: Port, memory: NDArray, step: float) -> Motion:
    return motion


@by_type
def steady_relief(valve: Any, pressure: float) -> float:
    """Steady flow [m^3/s] at a pressure [Pa] before the valve."""
    raise TypeError(f"{valve} is not a relief valve")


@steady_relief.register
def _(valve: Relief, pressure: float) -> float:
    return steady_flow(pressure, valve)


@steady_relief.register
def _(valve: NoRelief, pressure: float) -> float:
    return 0.0


def begin_relief(valve: AnyRelief, pressure: float, flow: float, memory: NDArray) -> Motion:
    """The valve at rest under a pressure [Pa] with a flow [m^3/s] over it."""
    if isinstance(valve, NoRelief):
        return ABSENT
    return begin(rest(pressure, valve), pressure, flow, valve)
