"""The slot of the supply at its end of line 1. Which kind is fitted is known when a step is compiled."""

from typing import Any

from numpy.typing import NDArray

from twin.fixed_pump import FixedPump, delivery_pressure, displaced_oil
from twin.kernel import by_type, interpreted
from twin.oil import Oil
from twin.port import Port
from twin.pressure_source import PressureSource, sourced
from twin.pump import Pump, pumped_oil, ripple_flow, speed_ratio
from twin.variable_pump import VariablePump, steady_variable, variable_flow, wanted_displacement

Supply = Pump | FixedPump | VariablePump | PressureSource


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


@supply_flow.register
def _(supply: FixedPump, tick: float, port: Port, before: float, memory: NDArray, oil: Oil, step: float) -> float:
    volume = supply.delivery * speed_ratio(tick * step, supply)
    p = delivery_pressure(port, volume, -supply.leakage, oil)
    return displaced_oil(p, volume, -supply.leakage, oil)[0]


@supply_flow.register
def _(supply: VariablePump, tick: float, port: Port, before: float, memory: NDArray, oil: Oil, step: float) -> float:
    return variable_flow(tick, port, before, memory, supply, oil, step)


@supply_flow.register
def _(supply: PressureSource, tick: float, port: Port, before: float, memory: NDArray, oil: Oil, step: float) -> float:
    return sourced(port, speed_ratio(tick * step, supply), supply, oil)


@by_type
def steady_supply(supply: Any, pressure: float, ratio: float, oil: Oil) -> tuple[float, float]:
    """Mean oil delivered [m^3/s] at a pressure [Pa], and its slope [m^3/(s Pa)]; ratio: of the pump's full speed."""
    raise TypeError(f"{supply} is not a supply")


@steady_supply.register
def _(supply: Pump, pressure: float, ratio: float, oil: Oil) -> tuple[float, float]:
    return pumped_oil(pressure, ratio, supply, oil.bulk_modulus)


@steady_supply.register
def _(supply: FixedPump, pressure: float, ratio: float, oil: Oil) -> tuple[float, float]:
    return displaced_oil(pressure, supply.delivery * ratio, -supply.leakage, oil)


@steady_supply.register
def _(supply: VariablePump, pressure: float, ratio: float, oil: Oil) -> tuple[float, float]:
    return steady_variable(pressure, ratio, supply, oil)


@steady_supply.register
def _(supply: PressureSource, pressure: float, ratio: float, oil: Oil) -> tuple[float, float]:
    return (supply.pressure * ratio - pressure) / supply.resistance, -1.0 / supply.resistance


def starting_ratio(supply: Supply) -> float:
    """Speed at the start over full speed."""
    return interpreted(speed_ratio)(0.0, supply)


def begin_supply(supply: Supply, pressure: float, memory: NDArray) -> None:
    """At rest at a delivery pressure [Pa]."""
    if isinstance(supply, VariablePump):
        memory[0] = interpreted(wanted_displacement)(pressure, supply)
