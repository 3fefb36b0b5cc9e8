"""The neck of a chamber: what oil must pass between a line's end and the chamber behind it, as the law of one instant.

Each direction has a check valve's way with its cracking pressure, a way beside it without one, and what is in series
with both:

    d = drop over the ways,   q = q_check(d - offset) + q_beside(d),   d + a_after q^2 + b_after q = p_source - p_sink,

each way a q^2 + b q, the check valve's open only beyond its offset: set-valued, no stiff spring. All of it takes
energy out, whatever the pressures. Line and chamber are ports, so the flow is one unknown of a monotone equation: in
closed form but where both ways are open.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined, kernel
from twin.oil import Oil
from twin.orifice import Orifice, quadratic_flow, resistance
from twin.port import Port

MOST_ITERATIONS = 60
CLOSE = 1e-12  # of the drop
INFINITE = math.inf


class Side(NamedTuple):
    """One direction; a in Pa s^2/m^6, infinite where shut, b in Pa s/m^3."""

    offset: float  # [Pa], at which the check valve cracks
    a: float  # of the check valve's way
    b: float
    a_beside: float  # of the way without a check valve
    b_beside: float
    a_after: float  # in series with both
    b_after: float


class Neck(NamedTuple):
    """Both directions."""

    into: Side  # from the line to the chamber
    out: Side


@inlined
def plain_side(a: float, b: float) -> Side:
    """One way without a check valve."""
    return Side(0.0, INFINITE, 0.0, a, b, 0.0, 0.0)


@inlined
def checked_side(offset: float, a: float, b: float, a_beside: float, b_beside: float) -> Side:
    """A check valve's way and one beside it."""
    return Side(offset, a, b, a_beside, b_beside, 0.0, 0.0)


@inlined
def way(area: float, orifice: Orifice, oil: Oil) -> tuple[float, float]:
    """(a, b) of an edge of an area [m^2]; shut at none."""
    if area <= 0.0:
        return INFINITE, 0.0
    return resistance(area, orifice, oil)


@inlined
def in_series(side: Side, a: float, b: float) -> Side:
    """The same with a further resistance before or behind it."""
    return Side(side.offset, side.a, side.b, side.a_beside, side.b_beside, side.a_after + a, side.b_after + b)


@inlined
def side_flow(drop: float, impedance: float, side: Side) -> float:
    """Flow [m^3/s] at a drop [Pa] that falls by an impedance [Pa s/m^3] with it; none against the drop."""
    if drop <= 0.0:
        return 0.0
    b = side.b_after + impedance
    beside = quadratic_flow(drop, side.a_beside + side.a_after, side.b_beside + b)
    left = drop - (side.a_after * beside + b) * beside
    if left <= side.offset or side.a == INFINITE:
        return beside
    if side.a_beside == INFINITE:
        return quadratic_flow(drop - side.offset, side.a + side.a_after, side.b + b)
    return _shared_flow(
        drop, left, side.offset, side.a, side.b, side.a_beside, side.b_beside, side.a_after, b
    )  # fmt: skip


@kernel
def _shared_flow(
    drop: float, high: float, low: float, a: float, b: float, a_beside: float, b_beside: float, a_after: float,
    b_after: float,
) -> float:  # fmt: skip
    """Flow through both ways: Newton for the drop d over them, kept between the offset and that without the check."""
    offset, d = low, low
    q = 0.0
    for _ in range(MOST_ITERATIONS):
        check, beside = quadratic_flow(d - offset, a, b), quadratic_flow(d, a_beside, b_beside)
        q = check + beside
        excess = d + (a_after * q + b_after) * q - drop
        if abs(excess) <= CLOSE * drop:
            break
        if excess > 0.0:
            high = d
        else:
            low = d
        by_drop = 1.0 / (2.0 * a * check + b) + 1.0 / (2.0 * a_beside * beside + b_beside)
        d -= excess / (1.0 + (2.0 * a_after * q + b_after) * by_drop)
        if not low < d < high:
            d = 0.5 * (low + high)
    return q


@inlined
def neck_flow(line: Port, chamber: Port, neck: Neck, oil: Oil) -> float:
    """Q [m^3/s] from the line's end into the chamber; at most the receiving end is a cavity while oil flows."""
    vapour = oil.vapour_pressure
    into = max(line.free, vapour) >= max(chamber.free, vapour)
    source, sink, side = (line, chamber, neck.into) if into else (chamber, line, neck.out)
    q = side_flow(source.free - sink.free, source.impedance + sink.impedance, side)
    if sink.free + sink.impedance * q < vapour:
        q = side_flow(source.free - vapour, source.impedance, side)
    return q if into else -q


@inlined
def steady_flow(drop: float, neck: Neck) -> float:
    """Q [m^3/s] into the chamber at a drop [Pa] from the line to it."""
    return side_flow(drop, 0.0, neck.into) if drop >= 0.0 else -side_flow(-drop, 0.0, neck.out)
