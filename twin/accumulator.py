"""Bladder accumulator: gas behind oil, filled through an orifice at a place where lines meet.

    (p_g + p_a) V^n = (p_0 + p_a) V_0^n,   V = V_0 - S,   p - p_g = a Q|Q| + b Q,   S' = Q,   S >= 0

Q flows into it, S is its oil, V the gas, V_0 its volume with the bladder expanded, p_0 the precharge, p_a the
atmosphere. n is 1 for slow, isothermal changes and about 1.4 for fast ones of nitrogen. At S = 0 the bladder shuts the
inlet: nothing flows out, and nothing in before p exceeds p_0. The bladder has no mass; the compression of its oil,
p S/B, is left out.

A step is the implicit midpoint rule with S between the instants, S_1 = S_0 + h Q, p_g taken at S_0 + h Q/2 by its
slope: oil is counted exactly, the gas gives back what it took to order 2, the orifice only takes. With the rest of the
place linear, p = c + Z (brought - Q), the step is one quadratic. What else meets there is solved first, against a port
with the accumulator's slope in it; then the accumulator takes what was brought, by its own law.
"""

import math
from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.kernel import by_type, inlined
from twin.oil import Oil
from twin.orifice import quadratic_flow
from twin.port import Port, joined

ATMOSPHERE = 1e5  # p_a [Pa], as of the vapour pressure in `rig.py`
MEMORY = ("oil", "flow", "brought", "gas")  # S [m^3]; Q and what others brought there [m^3/s]; p_g [Pa]
OIL, FLOW, BROUGHT, GAS = range(4)
GREATEST_SHARE = 0.5  # of the gas volume that a step may fill


class NoAccumulator(NamedTuple):
    """Nothing is fitted."""


class Accumulator(NamedTuple):
    """Gas, and the inlet orifice."""

    volume: float  # V_0 [m^3]
    precharge: float  # p_0 [Pa], gauge
    exponent: float  # n
    quadratic: float  # a [Pa s^2/m^6]
    linear: float  # b [Pa s/m^3]


AnyAccumulator = Accumulator | NoAccumulator


@by_type
def is_fitted(accumulator: Any) -> bool:
    """Is there one?"""
    raise TypeError(f"{accumulator} is not an accumulator")


@is_fitted.register
def _(accumulator: NoAccumulator) -> bool:
    return False


@is_fitted.register
def _(accumulator: Accumulator) -> bool:
    return True


@inlined
def gas_pressure(oil: float, accumulator: Accumulator) -> float:
    """p_g [Pa], gauge, with some oil [m^3] in it."""
    compression = accumulator.volume / (accumulator.volume - oil)
    return (accumulator.precharge + ATMOSPHERE) * compression**accumulator.exponent - ATMOSPHERE


@inlined
def gas_stiffness(oil: float, accumulator: Accumulator) -> float:
    """dp_g/dS [Pa/m^3]."""
    absolute = gas_pressure(oil, accumulator) + ATMOSPHERE
    return accumulator.exponent * absolute / (accumulator.volume - oil)


def oil_at_rest(pressure: float, accumulator: Accumulator) -> float:
    """S [m^3] at a steady pressure [Pa], the gas on its polytrope."""
    if pressure <= accumulator.precharge:
        return 0.0
    ratio = (accumulator.precharge + ATMOSPHERE) / (pressure + ATMOSPHERE)
    return accumulator.volume * (1.0 - ratio ** (1.0 / accumulator.exponent))


def gas_energy(oil: float, accumulator: Accumulator) -> float:
    """What the gas has taken from the oil since the bladder was expanded [J]: the integral of p_g dS."""
    v_0, n = accumulator.volume, accumulator.exponent
    stretched = math.log(v_0 / (v_0 - oil))
    work = stretched if n == 1.0 else math.expm1((n - 1.0) * stretched) / (n - 1.0)
    return (accumulator.precharge + ATMOSPHERE) * v_0 * work - ATMOSPHERE * oil


def begin_accumulator(accumulator: AnyAccumulator, pressure: float, brought: float, memory: NDArray) -> None:
    """At rest at a pressure [Pa]; brought: flow of the others into the place [m^3/s]."""
    if isinstance(accumulator, Accumulator):
        oil = oil_at_rest(pressure, accumulator)
        memory[: len(MEMORY)] = oil, 0.0, brought, max(pressure, accumulator.precharge)


@by_type
def gas_capacity(accumulator: Any, pressure: float) -> float:
    """Oil per pressure [m^3/Pa] at a steady pressure [Pa] beyond its inlet; 0.0 while it is shut."""
    raise TypeError(f"{accumulator} is not an accumulator")


@gas_capacity.register
def _(accumulator: NoAccumulator, pressure: float) -> float:
    return 0.0


@gas_capacity.register
def _(accumulator: Accumulator, pressure: float) -> float:
    if pressure <= accumulator.precharge:
        return 0.0
    ratio = (accumulator.precharge + ATMOSPHERE) / (pressure + ATMOSPHERE)
    gas = accumulator.volume * ratio ** (1.0 / accumulator.exponent)
    return gas / (accumulator.exponent * (pressure + ATMOSPHERE))


@by_type
def with_accumulator(accumulator: Any, rest: Port, memory: NDArray, oil: Oil, step: float) -> Port:
    """What others meet at the place; rest: the port without the accumulator."""
    raise TypeError(f"{accumulator} is not an accumulator")


@with_accumulator.register
def _(accumulator: NoAccumulator, rest: Port, memory: NDArray, oil: Oil, step: float) -> Port:
    return rest


@with_accumulator.register
def _(accumulator: Accumulator, rest: Port, memory: NDArray, oil: Oil, step: float) -> Port:
    """The accumulator by its slope about the flow that it takes if the others bring what they brought before."""
    stored, least = memory[OIL], -memory[OIL] / step
    q = drawn(accumulator, rest, memory[BROUGHT], stored, oil, step)
    if q <= least:
        return Port(rest.free - rest.impedance * least, rest.impedance)
    gas, half = gas_pressure(stored, accumulator), 0.5 * step * gas_stiffness(stored, accumulator)
    slope = half + accumulator.linear + 2.0 * accumulator.quadratic * abs(q)
    return joined(rest.free, rest.impedance, gas - accumulator.quadratic * abs(q) * q, slope)


@by_type
def taken(accumulator: Any, rest: Port, brought: float, memory: NDArray, oil: Oil, step: float) -> float:
    """Flow [m^3/s] into it, not yet counted; brought: flow of the others into the place."""
    raise TypeError(f"{accumulator} is not an accumulator")


@taken.register
def _(accumulator: NoAccumulator, rest: Port, brought: float, memory: NDArray, oil: Oil, step: float) -> float:
    return 0.0


@taken.register
def _(accumulator: Accumulator, rest: Port, brought: float, memory: NDArray, oil: Oil, step: float) -> float:
    return drawn(accumulator, rest, brought, memory[OIL], oil, step)


@by_type
def fill_accumulator(accumulator: Any, rest: Port, brought: float, memory: NDArray, oil: Oil, step: float) -> float:
    """The same, counted in its memory."""
    raise TypeError(f"{accumulator} is not an accumulator")


@fill_accumulator.register
def _(accumulator: NoAccumulator, rest: Port, brought: float, memory: NDArray, oil: Oil, step: float) -> float:
    return 0.0


@fill_accumulator.register
def _(accumulator: Accumulator, rest: Port, brought: float, memory: NDArray, oil: Oil, step: float) -> float:
    stored = memory[OIL]
    q = drawn(accumulator, rest, brought, stored, oil, step)
    memory[OIL] = stored + step * q if q > -stored / step else 0.0
    memory[GAS] = gas_pressure(stored, accumulator) + 0.5 * step * q * gas_stiffness(stored, accumulator)
    memory[FLOW], memory[BROUGHT] = q, brought
    return q


@inlined
def drawn(accumulator: Accumulator, rest: Port, brought: float, stored: float, oil: Oil, step: float) -> float:
    """Q [m^3/s] of a step with `stored` oil [m^3] at its beginning."""
    gas, half = gas_pressure(stored, accumulator), 0.5 * step * gas_stiffness(stored, accumulator)
    open_place = rest.free + rest.impedance * brought
    a, b = accumulator.quadratic, accumulator.linear + half
    q = quadratic_flow(open_place - gas, a, b + rest.impedance)
    if open_place - rest.impedance * q < oil.vapour_pressure:
        q = quadratic_flow(oil.vapour_pressure - gas, a, b)
    most = GREATEST_SHARE * (accumulator.volume - stored) / step
    return min(max(q, -stored / step), most) if stored > 0.0 else min(max(q, 0.0), most)
