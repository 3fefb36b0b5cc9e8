"""The slot of the supply at its end of line 1. Which kind is fitted is known when a step is compiled."""

from typing import Any

from numpy.typing import NDArray

from twin.kernel import by_type
from twin.oil import Oil
from twin.port import Port
from twin.pump import Pump, pumped_oil, ripple_flow, speed_ratio

Supply = Pump


@by_type
def supply_flow(supply: Any, tick: float, port: Port, before: float, memory: NDArray, oil: Oil, step: float) -> float:
    """Oil delivered [m^3/s] at the instant of a tick; before: pressure at the instant before; memory: of the slot."""
    raise TypeError(f"{supply} is not a supply")


@supply_flow.register
def _(supply: Pump, tick: float, port: Port, before: float, memory: NDArray, oil: Oil, step: float) -> float:
    """Its leakage is linearised about the last pressure."""
    time = tick * step
    mean, slope = pumped_oil(before, speed_ratio(time, supply), supply, oil.bulk_modulus)
    ripple = ripple_flow(time + 0.5 * step, step, supply)
    inflow = mean + ripple - slope * before
    p = max(oil.vapour_pressure, (port.free + port.impedance * inflow) / (1.0 - port.impedance * slope))
    return inflow + slope * p


@by_type
def steady_supply(supply: Any, pressure: float, ratio: float, oil: Oil) -> tuple[float, float]:
    """Mean oil delivered [m^3/s] at a pressure [Pa], and its slope [m^3/(s Pa)]; ratio: of the pump's full speed."""
    raise TypeError(f"{supply} is not a supply")


@steady_supply.register
def _(supply: Pump, pressure: float, ratio: float, oil: Oil) -> tuple[float, float]:
    return pumped_oil(pressure, ratio, supply, oil.bulk_modulus)


@by_type
def starting_ratio(supply: Any) -> float:
    """Speed at the start over full speed."""
    raise TypeError(f"{supply} is not a supply")


@starting_ratio.register
def _(supply: Pump) -> float:
    return speed_ratio(0.0, supply)
