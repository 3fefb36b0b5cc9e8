"""Motion of the valve with impacts on its seat: Dormand-Prince 5(4) from event to event, each at its own instant.

An event is solved for by the length of the step that ends in it, so it is as exact as the integration; there is no
penalty spring. At an impact y2 becomes -r y2. Impacts slower than REST on a seat that pressure does not yet lift end
the bouncing; the shut valve then waits until y3 = e, in closed form, as nothing flows.
"""

from typing import NamedTuple

from twin.chatter.system import System, rates
from twin.kernel import inlined, kernel

TOP, HIT, END = 1.0, 2.0, 3.0  # why a flight ends: highest lift, impact, time
LONGEST, SHORTEST = 0.5, 1e-12  # of a step: no event hides between two others
MOST = 100_000  # steps of a flight: a poppet that comes to rest without an event flies no further
REST = 1e-9  # of the steady lift, per unit of time


class Point(NamedTuple):
    """A place on the way."""

    time: float
    y1: float
    y2: float
    y3: float
    step: float  # the step to try next
    event: float  # TOP, HIT, END; 0.0: none


class Move(NamedTuple):
    """A step."""

    y1: float
    y2: float
    y3: float
    error: float  # greatest of the three


@inlined
def move(y1: float, y2: float, y3: float, h: float, s: System) -> Move:
    """One step of Dormand and Prince, order 5, its error by the embedded one of order 4."""
    a1, a2, a3 = rates(y1, y2, y3, s)
    g = h / 5.0
    b1, b2, b3 = rates(y1 + g * a1, y2 + g * a2, y3 + g * a3, s)
    p, q = h * 3.0 / 40.0, h * 9.0 / 40.0
    c1, c2, c3 = rates(y1 + p * a1 + q * b1, y2 + p * a2 + q * b2, y3 + p * a3 + q * b3, s)
    p, q, u = h * 44.0 / 45.0, -h * 56.0 / 15.0, h * 32.0 / 9.0
    d1, d2, d3 = rates(y1 + p * a1 + q * b1 + u * c1, y2 + p * a2 + q * b2 + u * c2, y3 + p * a3 + q * b3 + u * c3, s)
    p, q, u, v = h * 19372.0 / 6561.0, -h * 25360.0 / 2187.0, h * 64448.0 / 6561.0, -h * 212.0 / 729.0
    e1, e2, e3 = rates(
        y1 + p * a1 + q * b1 + u * c1 + v * d1,
        y2 + p * a2 + q * b2 + u * c2 + v * d2,
        y3 + p * a3 + q * b3 + u * c3 + v * d3,
        s,
    )
    p, q, u = h * 9017.0 / 3168.0, -h * 355.0 / 33.0, h * 46732.0 / 5247.0
    v, w = h * 49.0 / 176.0, -h * 5103.0 / 18656.0
    f1, f2, f3 = rates(
        y1 + p * a1 + q * b1 + u * c1 + v * d1 + w * e1,
        y2 + p * a2 + q * b2 + u * c2 + v * d2 + w * e2,
        y3 + p * a3 + q * b3 + u * c3 + v * d3 + w * e3,
        s,
    )
    p, q, u = h * 35.0 / 384.0, h * 500.0 / 1113.0, h * 125.0 / 192.0
    v, w = -h * 2187.0 / 6784.0, h * 11.0 / 84.0
    n1 = y1 + p * a1 + q * c1 + u * d1 + v * e1 + w * f1
    n2 = y2 + p * a2 + q * c2 + u * d2 + v * e2 + w * f2
    n3 = y3 + p * a3 + q * c3 + u * d3 + v * e3 + w * f3
    g1, g2, g3 = rates(n1, n2, n3, s)
    p, q, u = h * 71.0 / 57600.0, -h * 71.0 / 16695.0, h * 71.0 / 1920.0
    v, w, z = -h * 17253.0 / 339200.0, h * 22.0 / 525.0, -h / 40.0
    x1 = abs(p * a1 + q * c1 + u * d1 + v * e1 + w * f1 + z * g1)
    x2 = abs(p * a2 + q * c2 + u * d2 + v * e2 + w * f2 + z * g2)
    x3 = abs(p * a3 + q * c3 + u * d3 + v * e3 + w * f3 + z * g3)
    return Move(n1, n2, n3, max(x1, max(x2, x3)))


@kernel
def moved(y1: float, y2: float, y3: float, h: float, s: System) -> Move:
    """`move`, for the search of an event."""
    return move(y1, y2, y3, h, s)


@kernel
def event_step(y1: float, y2: float, y3: float, high: float, lift: bool, s: System) -> float:
    """The step at whose end y1 (lift) or y2 (else) passes zero, as it does in 0 .. high: Newton within a bracket."""
    low = 0.0
    start = y1 if lift else y2
    end = moved(y1, y2, y3, high, s)
    sign = 1.0 if (end.y1 if lift else end.y2) > 0.0 else -1.0
    h = 0.5 * high if start == 0.0 else high * abs(start) / (abs(start) + abs(end.y1 if lift else end.y2))
    for _ in range(60):
        at = moved(y1, y2, y3, h, s)
        value = sign * (at.y1 if lift else at.y2)
        if value > 0.0:
            high = h
        else:
            low = h
        slope = sign * (at.y2 if lift else rates(at.y1, at.y2, at.y3, s)[1])
        then = h - value / slope if slope > 0.0 else low
        if not low < then < high:
            then = 0.5 * (low + high)
        if abs(then - h) <= 1e-15 * high or high - low <= 4e-16 * high:
            return then
        h = then
    return h


@kernel
def advance(at: Point, end: float, tolerance: float, s: System) -> Point:
    """On to the next event, or to the time `end`; tolerance: of a step, absolute. END after MOST steps, too."""
    t, y1, y2, y3, h = at.time, at.y1, at.y2, at.y3, at.step
    for _ in range(MOST):
        h = min(h, LONGEST)
        last = t + h >= end
        length = end - t if last else h
        n = move(y1, y2, y3, length, s)
        ratio = n.error / tolerance
        if ratio > 1.0 and length > SHORTEST:
            h = length * max(0.2, 0.9 * ratio**-0.2)
            continue
        bigger = length * min(4.0, 0.9 * max(ratio, 1e-6) ** -0.2)
        if y2 > 0.0 and n.y2 <= 0.0:
            g = event_step(y1, y2, y3, length, False, s)
            n = move(y1, y2, y3, g, s)
            return Point(t + g, n.y1, 0.0, n.y3, bigger, TOP)
        below = n.y1 < 0.0
        reach = length
        if not below and y2 < 0.0 and n.y2 > 0.0:
            reach = event_step(y1, y2, y3, length, False, s)
            below = moved(y1, y2, y3, reach, s).y1 < 0.0
        if below:
            g = event_step(y1, y2, y3, reach, True, s)
            n = move(y1, y2, y3, g, s)
            return Point(t + g, 0.0, n.y2, n.y3, bigger, HIT)
        t, y1, y2, y3 = t + length, n.y1, n.y2, n.y3
        if last:
            return Point(end, y1, y2, y3, bigger, END)
        h = bigger
    return Point(t, y1, y2, y3, h, END)


@kernel
def bounce(at: Point, scale: float, s: System) -> Point:
    """What follows an impact: a rebound; or rest on the seat until the pressure lifts the poppet."""
    speed = -s.restitution * at.y2
    shut = s.precompression - at.y3
    if speed > REST * scale or shut <= 0.0:
        return Point(at.time, 0.0, max(speed, 0.0), at.y3, at.step, 0.0)
    wait = shut / (s.beta * s.flow)
    return Point(at.time + wait, 0.0, 0.0, s.precompression, at.step, 0.0)


@inlined
def next_event(at: Point, end: float, tolerance: float, scale: float, s: System) -> Point:
    """The next event; an impact of the event before is answered first."""
    if at.event == HIT:
        at = bounce(at, scale, s)
    return advance(at, end, tolerance, s)


@kernel
def seated(y3: float, s: System) -> Point:
    """A shut valve at a pressure, at the moment it can open."""
    wait = max(0.0, s.precompression - y3) / (s.beta * s.flow)
    return Point(wait, 0.0, 0.0, max(y3, s.precompression), 1e-3, 0.0)
