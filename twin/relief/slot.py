"""The slot of the relief valve, at the tee or at the end of a line of its own. Which kind is fitted is known when a
step is compiled."""

from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.kernel import by_type, interpreted
from twin.port import Port
from twin.relief.direct import DirectRelief, begin_direct, direct_flow, direct_slope, steady_direct
from twin.relief.motion import Motion, ReliefState, begin
from twin.relief.network import Relief
from twin.relief.steady import rest, steady_flow, steady_slope
from twin.relief.valve import step_valve


class NoRelief(NamedTuple):
    """There is no relief valve."""


AnyRelief = Relief | DirectRelief | NoRelief
ABSENT = Motion(ReliefState(0.0, 0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@by_type
def move_relief(valve: Any, motion: Motion, before: float, port: Port, memory: NDArray, step: float) -> Motion:
    """The valve a step [s] later; its `flow` is what it takes from the port. before: port.free of the last instant."""
    raise TypeError(f"{valve} is not a relief valve")


@move_relief.register
def _(valve: Relief, motion: Motion, before: float, port: Port, memory: NDArray, step: float) -> Motion:
    return step_valve(motion, before, port.free, port.impedance, valve, step)[0]


@move_relief.register
def _(valve: DirectRelief, motion: Motion, before: float, port: Port, memory: NDArray, step: float) -> Motion:
    """Its state is in the memory; of the motion only the flow is used."""
    flow = direct_flow(port, memory, valve)
    return Motion(motion.state, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, flow, 0.0)


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
def _(valve: DirectRelief, pressure: float) -> float:
    return steady_direct(pressure, valve)


@steady_relief.register
def _(valve: NoRelief, pressure: float) -> float:
    return 0.0


def relief_slope(valve: AnyRelief, pressure: float) -> float:
    """Slope of the steady flow by the pressure [m^3/(s Pa)]."""
    if isinstance(valve, NoRelief):
        return 0.0
    if isinstance(valve, DirectRelief):
        return interpreted(direct_slope)(pressure, valve)
    return steady_slope(pressure, valve)


def begin_relief(valve: AnyRelief, pressure: float, flow: float, memory: NDArray) -> Motion:
    """The valve at rest under a pressure [Pa] with a flow [m^3/s] over it."""
    if isinstance(valve, NoRelief):
        return ABSENT
    if isinstance(valve, DirectRelief):
        interpreted(begin_direct)(pressure, memory, valve)
        return ABSENT._replace(flow=flow)
    return begin(rest(pressure, valve), pressure, flow, valve)
