"""Up to five lands open at once between four ports, each with a leak beside its opening.

A land's drop is R(T), `land_law.py`, T its flow; a port's pressure max(p_v, c + Z q). The answer is where the convex
function

    sum over lands of int R dT  +  sum over ports of int p dq

of the flows T is smallest. So there is one answer, whatever is open and wherever there is vapour. Newton's method finds
it: each land is replaced by a straight line, the slope of which is the mean of those at its present flow and at the
flow of its present drop (the chord, for a parabola), and the straight network is solved by eliminating A and B, then P
and T, without a subtraction, so that it cannot lose digits. A step that would overshoot along its own direction is
shortened. What the ports take are sums of the same five flows, so oil is kept exactly, however far the iteration went.
"""

from typing import NamedTuple

from twin.kernel import inlined
from twin.land_law import Laws, land_at, straight
from twin.lands import Lands, Ports
from twin.oil import Oil
from twin.port import pressure

MOST_ITERATIONS = 60
TIGHT = 1e-4  # [Pa], drop of a land that may be left over
NEAR = 1e-2  # share of the worst excess by which the slope of a land is not trusted
FIRM = 1.0  # [m^3/(s Pa)], admittance of a port at the vapour pressure
WEAKER = 0.1  # what an end of the bracket counts for that did not move twice
OVERSHOT = 0.3  # share of the slope before a step that it may have, the other way round, after it


class Search(NamedTuple):
    """A way of the flows, and how fast the convex function falls at its start [W]."""

    flows: Lands
    falls: float


class Bracket(NamedTuple):
    """A share of the way, and between which shares the least lies, with how fast the function falls there [W]."""

    share: float
    low: float
    at_low: float
    high: float
    at_high: float  # 0 until a share is known that goes too far
    side: float  # below 0 where the share before went too far, above 0 where it did not go far enough


@inlined
def port_flows(q: Lands) -> tuple[float, float, float, float]:
    """What the lands deliver into P, A, B, T [m^3/s]."""
    return -(q.p_a + q.p_b + q.p_t), q.p_a - q.a_t, q.p_b - q.b_t, q.b_t + q.a_t + q.p_t


@inlined
def port_pressures(q: Lands, ports: Ports, vapour: float) -> tuple[float, float, float, float]:
    """Pressures [Pa] of P, A, B, T at these flows."""
    p, a, b, t = port_flows(q)
    return (
        pressure(ports.p, p, vapour),
        pressure(ports.a, a, vapour),
        pressure(ports.b, b, vapour),
        pressure(ports.t, t, vapour),
    )


@inlined
def _admittance(impedance: float, p: float, vapour: float) -> float:
    return 1.0 / impedance if p > vapour else FIRM


@inlined
def _correction(s, y_p: float, y_a: float, y_b: float, y_t: float) -> Lands:
    """What the flows change by, in the network of straight lines s: of the ports with their admittances y."""
    p_a, b_t, p_b, a_t, p_t = s
    k_a, k_b = y_a + p_a.slope + a_t.slope, y_b + p_b.slope + b_t.slope
    r_a, r_b = (p_a.more - a_t.more) / k_a, (p_b.more - b_t.more) / k_b
    between = p_a.slope * a_t.slope / k_a + p_b.slope * b_t.slope / k_b + p_t.slope
    own_p = y_p + p_a.slope * y_a / k_a + p_b.slope * y_b / k_b
    own_t = y_t + a_t.slope * y_a / k_a + b_t.slope * y_b / k_b
    r_p = p_a.slope * r_a + p_b.slope * r_b - (p_a.more + p_b.more + p_t.more)
    r_t = a_t.slope * r_a + b_t.slope * r_b + a_t.more + b_t.more + p_t.more
    whole = own_p * own_t + between * (own_p + own_t)
    p = ((own_t + between) * r_p + between * r_t) / whole
    t = ((own_p + between) * r_t + between * r_p) / whole
    a = r_a + (p_a.slope * p + a_t.slope * t) / k_a
    b = r_b + (p_b.slope * p + b_t.slope * t) / k_b
    return Lands(
        p_a.more + p_a.slope * (p - a),
        b_t.more + b_t.slope * (b - t),
        p_b.more + p_b.slope * (p - b),
        a_t.more + a_t.slope * (a - t),
        p_t.more + p_t.slope * (p - t),
    )


@inlined
def _along(s, way: Lands) -> float:
    """Sum of excess times flow: how fast the convex function falls along a way [W]."""
    return (
        s[0].excess * way.p_a
        + s[1].excess * way.b_t
        + s[2].excess * way.p_b
        + s[3].excess * way.a_t
        + s[4].excess * way.p_t
    )


@inlined
def _worst(s) -> float:
    return max(max(abs(s[0].excess), abs(s[1].excess)), max(abs(s[2].excess), abs(s[3].excess)), abs(s[4].excess))


@inlined
def _moved(q: Lands, way: Lands, share: float) -> Lands:
    return Lands(
        q.p_a + share * way.p_a,
        q.b_t + share * way.b_t,
        q.p_b + share * way.p_b,
        q.a_t + share * way.a_t,
        q.p_t + share * way.p_t,
    )


@inlined
def _bracketed(reach: Bracket, falls: float, falls_first: float) -> tuple[Bracket, bool]:
    """Where to try next along a way, and whether the last try will do: regula falsi (Illinois) after an overshoot.

    falls: how fast the convex function still falls there; falls_first: at the start of the way.
    """
    if falls >= -OVERSHOT * falls_first and (reach.at_high == 0.0 or falls <= OVERSHOT * falls_first):
        return reach, True
    share, low, at_low, high, at_high, _ = reach
    if falls < 0.0:
        high, at_high = share, falls
        at_low *= WEAKER if reach.side < 0.0 else 1.0
    else:
        low, at_low = share, falls
        at_high *= WEAKER if reach.side > 0.0 else 1.0
    share = (low * at_high - high * at_low) / (at_high - at_low)
    return Bracket(share, low, at_low, high, at_high, falls), False


@inlined
def _searched(
    s, laws: Laws, least: float, p: float, a: float, b: float, t: float, ports: Ports, vapour: float
) -> Search:
    """The way of Newton's method."""
    lines = (
        straight(s[0], laws.p_a, least),
        straight(s[1], laws.b_t, least),
        straight(s[2], laws.p_b, least),
        straight(s[3], laws.a_t, least),
        straight(s[4], laws.p_t, least),
    )
    flows = _correction(
        lines,
        _admittance(ports.p.impedance, p, vapour),
        _admittance(ports.a.impedance, a, vapour),
        _admittance(ports.b.impedance, b, vapour),
        _admittance(ports.t.impedance, t, vapour),
    )
    return Search(flows, _along(s, flows))


@inlined
def _without_shut(q: Lands, laws: Laws) -> Lands:
    return Lands(
        0.0 if laws.p_a.shut else q.p_a,
        0.0 if laws.b_t.shut else q.b_t,
        0.0 if laws.p_b.shut else q.p_b,
        0.0 if laws.a_t.shut else q.a_t,
        0.0 if laws.p_t.shut else q.p_t,
    )


@inlined
def network_flows(ports: Ports, laws: Laws, guess: Lands, oil: Oil) -> tuple[Lands, int]:
    """Flows [m^3/s] of all lands, and the iterations that they took; guess: those of the instant before, say."""
    q, iterations = _without_shut(guess, laws), 0
    way, reach = Search(Lands(0.0, 0.0, 0.0, 0.0, 0.0), 0.0), Bracket(1.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    start = q
    while iterations < MOST_ITERATIONS:
        p, a, b, t = port_pressures(q, ports, oil.vapour_pressure)
        s = (
            land_at(q.p_a, p - a, laws.p_a),
            land_at(q.b_t, b - t, laws.b_t),
            land_at(q.p_b, p - b, laws.p_b),
            land_at(q.a_t, a - t, laws.a_t),
            land_at(q.p_t, p - t, laws.p_t),
        )
        worst = _worst(s)
        if worst <= TIGHT:
            break
        reach, fits = _bracketed(reach, _along(s, way.flows), way.falls)
        if fits:
            start, way = q, _searched(s, laws, NEAR * worst, p, a, b, t, ports, oil.vapour_pressure)
            reach = Bracket(1.0, 0.0, way.falls, 1.0, 0.0, 0.0)
        q = _moved(start, way.flows, reach.share)
        iterations += 1
    return q, iterations
