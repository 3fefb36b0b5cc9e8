"""Poppet, spring and volume in dimensionless form, for either seat.

(4.12), (4.40) of the thesis: `y1' = y2, y2' = -k y2 - y1 - e + y3, y3' = beta (q - phi)`. y1 lift, y3 pressure, e
precompression, q flow in, k damping; time in 1/omega of poppet and spring. phi = y1 sqrt(y3) over a chamfered edge,
turbulent, y1^3 y3 in a long conical gap, laminar. The lift the flow has lost, sigma y1 of (4.4), is left out.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined


class SeatLaw(NamedTuple):
    """Exponents of phi = y1^lift y3^pressure."""

    lift: float
    pressure: float


CHAMFERED = SeatLaw(1.0, 0.5)
CONICAL = SeatLaw(3.0, 1.0)
SEATS = {"chamfered": CHAMFERED, "conical": CONICAL}


class System(NamedTuple):
    """A valve with its volume; all [-]."""

    law: SeatLaw
    beta: float  # flow over stiffness of the volume
    flow: float  # q > 0
    precompression: float  # e >= 0
    damping: float  # k >= 0
    restitution: float  # of the seat, 0 .. 1


@inlined
def outflow(y1: float, y3: float, law: SeatLaw) -> float:
    """phi. Pressures below zero pass nothing."""
    if law.lift == 1.0 and law.pressure == 0.5:
        return y1 * math.sqrt(max(y3, 0.0))
    if law.lift == 3.0 and law.pressure == 1.0:
        return y1 * y1 * y1 * max(y3, 0.0)
    return math.copysign(abs(y1) ** law.lift, y1) * max(y3, 0.0) ** law.pressure


@inlined
def rates(y1: float, y2: float, y3: float, s: System) -> tuple[float, float, float]:
    """(4.12), (4.40)."""
    lift = -s.damping * y2 - y1 - s.precompression + y3
    return y2, lift, s.beta * (s.flow - outflow(y1, y3, s.law))


def derivative(y1: float, y3: float, orders: tuple[int, int], law: SeatLaw) -> float:
    """The derivative of phi, orders[0] times by y1 and orders[1] times by y3, at y1, y3 > 0."""
    return _power(y1, law.lift, orders[0]) * _power(y3, law.pressure, orders[1])


def _power(base: float, exponent: float, order: int) -> float:
    factor = math.prod(exponent - k for k in range(order))
    return factor * base ** (exponent - order) if factor else 0.0
