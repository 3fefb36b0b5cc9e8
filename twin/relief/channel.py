"""The oil before the pilot seat, with or without compressibility; which one is known when a step is compiled.

The thesis has none: p2 then follows from the flows of the instant. With C = V/B the pilot can chatter by its own oil,
C p2' = Q2 + A v - Q_pl - A_in u.
"""

from typing import Any, NamedTuple

from twin.kernel import by_type


class IncompressibleOil(NamedTuple):
    """No volume worth counting, as in the thesis."""


class CompressibleOil(NamedTuple):
    """A volume of oil."""

    capacity: float  # V/B [m^3/Pa]


Channel = IncompressibleOil | CompressibleOil


@by_type
def is_compressible(channel: Any) -> bool:
    """Does p2 have a rate of its own?"""
    raise TypeError(f"{channel} is not a channel")


@is_compressible.register
def _(channel: IncompressibleOil) -> bool:
    return False


@is_compressible.register
def _(channel: CompressibleOil) -> bool:
    return True


@by_type
def absorbed_per_pressure(channel: Any, h: float) -> float:
    """Flow into the oil per change of p2 over a time h [s], by the trapezoidal rule: 2 C/h [m^3/(s Pa)]."""
    raise TypeError(f"{channel} is not a channel")


@absorbed_per_pressure.register
def _(channel: IncompressibleOil, h: float) -> float:
    return 0.0


@absorbed_per_pressure.register
def _(channel: CompressibleOil, h: float) -> float:
    return 2.0 * channel.capacity / h
