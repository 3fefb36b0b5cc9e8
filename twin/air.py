"""Entrained air: how much oil a volume holds at a pressure, and how stiff it is.

Of a volume at atmospheric pressure p_0 a share alpha is air in bubbles, which change by p v^n = const, n = 1 isothermal
to 1.4 adiabatic; none dissolves. The rest is oil, 1 + p/B denser. Volumes add up (Cho et al. 2002; the "compression
only" law in the survey of Gholizadeh, Burton and Schoenau, 2011), so with p gauge and r = 1 + p/p_0

    V/S = (1 - alpha)/(1 + p/B) + alpha r^(-1/n),
    B_eff = (V/S) / ((1 - alpha)/(B (1 + p/B)^2) + alpha r^(-1/n)/(n p_0 r))

S the oil with its air at reference density, conserved by the circuit. Without air S/V = 1 + p/B. S/V rises with p and,
but for the oil's own 1/B, ever less, so that Newton's tangents come from below once and stay there.
"""

import math
from typing import Any, NamedTuple

from twin.kernel import by_type, inlined

ATMOSPHERE = 101325.0  # p_0 [Pa]
ROUNDS = 40  # of Newton at most: from vacuum to high pressure r doubles in each; two or three in a smooth step
CLOSE = 1e-3  # [Pa], change of the last round


class NoAir(NamedTuple):
    """Oil alone."""


class Air(NamedTuple):
    """Bubbles in the oil."""

    share: float  # alpha, of the volume at atmospheric pressure
    exponent: float  # n, polytropic


AnyAir = NoAir | Air


@by_type
def compression(air: Any, modulus: float, pressure: float) -> float:
    """S/V, oil at reference density over the volume it fills at a pressure [Pa]; modulus: B [Pa] without air."""
    raise TypeError(f"{air} is not air")


@compression.register
def _(air: NoAir, modulus: float, pressure: float) -> float:
    return 1.0 + pressure / modulus


@compression.register
def _(air: Air, modulus: float, pressure: float) -> float:
    return 1.0 / _specific_volume(air, modulus, pressure)


@inlined
def _specific_volume(air: Air, modulus: float, pressure: float) -> float:
    bubbles = air.share * math.pow(1.0 + pressure / ATMOSPHERE, -1.0 / air.exponent)
    return (1.0 - air.share) / (1.0 + pressure / modulus) + bubbles


@by_type
def compressibility(air: Any, modulus: float, pressure: float) -> float:
    """Slope of S/V by the pressure [1/Pa]."""
    raise TypeError(f"{air} is not air")


@compressibility.register
def _(air: NoAir, modulus: float, pressure: float) -> float:
    return 1.0 / modulus


@compressibility.register
def _(air: Air, modulus: float, pressure: float) -> float:
    return _steepness(air, modulus, pressure) / _specific_volume(air, modulus, pressure) ** 2


@inlined
def _steepness(air: Air, modulus: float, pressure: float) -> float:
    """-d(V/S)/dp [1/Pa]."""
    r, dense = 1.0 + pressure / ATMOSPHERE, 1.0 + pressure / modulus
    bubbles = air.share * math.pow(r, -1.0 / air.exponent) / (air.exponent * ATMOSPHERE * r)
    return (1.0 - air.share) / (modulus * dense * dense) + bubbles


@by_type
def pressure_at(air: Any, modulus: float, share: float, lowest: float) -> float:
    """The pressure [Pa] at which S/V is a share, at least the lowest."""
    raise TypeError(f"{air} is not air")


@pressure_at.register
def _(air: NoAir, modulus: float, share: float, lowest: float) -> float:
    return max(lowest, modulus * (share - 1.0))


@pressure_at.register
def _(air: Air, modulus: float, share: float, lowest: float) -> float:
    p = max(lowest, modulus * (share - 1.0) + air.share * modulus)  # from above: the oil alone, squeezed
    for _ in range(ROUNDS):
        then = p + (share - compression(air, modulus, p)) / compressibility(air, modulus, p)
        then, before = max(lowest, then), p
        p = then
        if abs(then - before) <= CLOSE:
            break
    return p


@by_type
def tangent(air: Any, modulus: float, volume: float, pressure: float) -> tuple[float, float]:
    """(C, S_0) of the tangent S = S_0 + C p [m^3/Pa, m^3] to what a volume holds; without air it is the law itself."""
    raise TypeError(f"{air} is not air")


@tangent.register
def _(air: NoAir, modulus: float, volume: float, pressure: float) -> tuple[float, float]:
    return volume / modulus, volume


@tangent.register
def _(air: Air, modulus: float, volume: float, pressure: float) -> tuple[float, float]:
    slope = compressibility(air, modulus, pressure)
    return volume * slope, volume * (compression(air, modulus, pressure) - slope * pressure)


@by_type
def rounds(air: Any) -> int:
    """How many tangents a solution may take."""
    raise TypeError(f"{air} is not air")


@rounds.register
def _(air: NoAir) -> int:
    return 1


@rounds.register
def _(air: Air) -> int:
    return ROUNDS


def effective_bulk_modulus(air: AnyAir, modulus: float, pressure: float) -> float:
    """B_eff [Pa], tangent, at a pressure [Pa]: (S/V)/(d(S/V)/dp); without air B itself, as lines take it."""
    if isinstance(air, NoAir):
        return modulus
    return compression(air, modulus, pressure) / compressibility(air, modulus, pressure)
