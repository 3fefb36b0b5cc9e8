"""One open land: an opening and a leak beside it, and the straight line that stands for it in Newton's method.

The opening takes d = a q|q| + b q, `orifice.py`, the leak g d. With the whole flow T = q + g d this is the quadratic
(1 + g b) q + g a q|q| = T, so the drop is explicit in the whole flow, and the whole flow in the drop.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined
from twin.oil import Oil
from twin.orifice import LEAST_AREA, Orifice, resistance

SOFTEST = 1e-3  # [Pa s/m^3], least slope of a land: some 1e-12 of a line's impedance


class Law(NamedTuple):
    """Drop d of a land by its flow: an opening, d = a q|q| + b q, and a leak g d beside it."""

    a: float  # [Pa s^2/m^6]
    b: float  # [Pa s/m^3]
    g: float  # [m^3/(s Pa)]
    shut: bool  # nothing passes


class Laws(NamedTuple):
    """One for each land."""

    p_a: Law
    b_t: Law
    p_b: Law
    a_t: Law
    p_t: Law


class At(NamedTuple):
    """A land at its present flow and the present drop between its ports."""

    drop: float  # [Pa]
    excess: float  # of the drop, beyond what the land takes [Pa]
    slope: float  # of what it takes [Pa s/m^3]


class Straight(NamedTuple):
    """A land as a straight line."""

    slope: float  # conductance [m^3/(s Pa)]
    more: float  # flow that it would take more if the pressures stayed [m^3/s]


@inlined
def land_law(area: float, leak: float, orifice: Orifice, oil: Oil) -> Law:
    """The law of a land with an opening [m^2] and a leak [m^3/(s Pa)]."""
    if area > LEAST_AREA:
        a, b = resistance(area, orifice, oil)
        return Law(a, b, leak, False)
    if leak > 0.0:
        return Law(0.0, 1.0 / leak, 0.0, False)
    return Law(0.0, 1.0, 0.0, True)


@inlined
def land_drop(flow: float, law: Law) -> tuple[float, float]:
    """Drop [Pa] of an open land at a flow [m^3/s], and its slope [Pa s/m^3]."""
    linear = 1.0 + law.g * law.b
    q = 2.0 * flow / (linear + math.sqrt(linear * linear + 4.0 * law.g * law.a * abs(flow)))
    slope = 2.0 * law.a * abs(q) + law.b
    return (law.a * abs(q) + law.b) * q, slope / (1.0 + law.g * slope)


@inlined
def land_flow(drop: float, law: Law) -> float:
    """Flow [m^3/s] of a land at a drop [Pa]: the inverse of `land_drop`."""
    if law.shut or drop == 0.0:
        return 0.0
    return 2.0 * drop / (law.b + math.sqrt(law.b * law.b + 4.0 * law.a * abs(drop))) + law.g * drop


@inlined
def land_at(flow: float, drop: float, law: Law) -> At:
    if law.shut:
        return At(drop, 0.0, 0.0)
    taken, slope = land_drop(flow, law)
    return At(drop, drop - taken, slope)


@inlined
def straight(at: At, law: Law, least: float) -> Straight:
    """The line about a land's present flow; least: drop [Pa] at which its slope is taken where its own is smaller."""
    if law.shut:
        return Straight(0.0, 0.0)
    there = math.sqrt(law.b * law.b + 4.0 * law.a * max(abs(at.drop), least))
    conductance = 1.0 / max(0.5 * (at.slope + there / (1.0 + law.g * there)), SOFTEST)
    return Straight(conductance, conductance * at.excess)
