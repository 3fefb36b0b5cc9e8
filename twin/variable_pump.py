"""Pressure-compensated pump of variable displacement: a swash plate that swings back beyond the cut-off pressure.

    Q = n V_max s - k p,   T s' = u(p) - s,   u = 1 - (1 - s_min) (p - p_cut)/dp_droop, between s_min and 1

s is the displacement over the greatest, T the time constant of the swash plate with its compensator (assumed to be of
first order), dp_droop the rise of pressure from the greatest to the least displacement: what a data sheet calls the
increase of pressure of the controller. Flow is counted at delivery pressure, as that of the other pumps.

A step solves swash plate and port together: s at its end is a sum of s before and of u before and after, the lag of
`lag.py`; u is straight in three pieces, and the flow falls with p, so there is one answer.
"""

from typing import NamedTuple

from numpy.typing import NDArray

from twin.fixed_pump import delivery_pressure, displaced_oil
from twin.kernel import inlined
from twin.lag import Lag
from twin.oil import Oil
from twin.port import Port
from twin.pump import speed_ratio

MEMORY = ("displacement",)  # s, over the greatest


class VariablePump(NamedTuple):
    """A pump at constant speed, once it has run up."""

    delivery: float  # n V_max, at full speed and no pressure [m^3/s]
    least: float  # s_min, least displacement over the greatest
    cut_off: float  # p_cut, pressure where the swash plate leaves its stop [Pa]
    droop: float  # rise of pressure to the least displacement [Pa]
    leakage: float  # k, to the tank [m^3/(s Pa)]
    time: float  # T [s]
    swash: Lag  # T over the step
    run_up: float  # from standstill at time 0, at constant acceleration [s]; 0.0: it runs already


@inlined
def wanted_displacement(pressure: float, pump: VariablePump) -> float:
    """u, the displacement that the compensator asks for, over the greatest."""
    share = min(max((pressure - pump.cut_off) / pump.droop, 0.0), 1.0)
    return 1.0 - (1.0 - pump.least) * share


@inlined
def variable_flow(
    tick: float, port: Port, before: float, memory: NDArray, pump: VariablePump, oil: Oil, step: float
) -> float:
    """Oil delivered [m^3/s] at the instant of a tick, and the swash plate moved there; before: pressure before it."""
    speed = pump.delivery * speed_ratio(tick * step, pump)
    held = pump.swash.kept * memory[0] + pump.swash.before * wanted_displacement(before, pump)
    p = _pressure(port, speed, held, pump, oil)
    memory[0] = held + pump.swash.after * wanted_displacement(p, pump)
    return displaced_oil(p, speed * memory[0], -pump.leakage, oil)[0]


@inlined
def _pressure(port: Port, speed: float, held: float, pump: VariablePump, oil: Oil) -> float:
    """p [Pa] at the step's end: on the piece of u that holds the answer."""
    after, fall = pump.swash.after, (1.0 - pump.least) / pump.droop
    beyond = pump.cut_off + pump.droop
    share, slope = held + after, 0.0
    if _surplus(pump.cut_off, port, speed * share, pump, oil) > 0.0:
        share, slope = held + after * (1.0 + fall * pump.cut_off), -speed * after * fall
        if _surplus(beyond, port, speed * (held + after * pump.least), pump, oil) > 0.0:
            share, slope = held + after * pump.least, 0.0
    return delivery_pressure(port, speed * share, slope - pump.leakage, oil)


@inlined
def _surplus(pressure: float, port: Port, volume: float, pump: VariablePump, oil: Oil) -> float:
    """How far the port's pressure lies above one [Pa] at which the swash plate gives a volume flow [m^3/s]."""
    return port.free + port.impedance * displaced_oil(pressure, volume, -pump.leakage, oil)[0] - pressure


@inlined
def steady_variable(pressure: float, ratio: float, pump: VariablePump, oil: Oil) -> tuple[float, float]:
    """Oil delivered [m^3/s] with the swash plate at rest, and its slope [m^3/(s Pa)]; ratio: of full speed."""
    speed, within = pump.delivery * ratio, pump.cut_off < pressure < pump.cut_off + pump.droop
    fall = speed * (1.0 - pump.least) / pump.droop if within else 0.0
    volume = speed * wanted_displacement(pressure, pump) + fall * pressure
    return displaced_oil(pressure, volume, -fall - pump.leakage, oil)
