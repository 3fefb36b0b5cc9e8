"""Squeeze film of a long conical seat: the oil that a cone draws in or pushes out when its lift changes.

Not in the thesis, which keeps the flow constant along the gap. A cone that opens at v widens the gap everywhere by
v sin a; continuity `Q' = -2 pi r v sin a`, r the cone's own radius, with the lubrication law `p' = Q/f`, f of (3.4).
Inlet and outlet at the pressures of the steady flow, which this one adds to.
"""

import math

from twin.seats.conical import ConicalSeat, gap


def displaced(x: float, seat: ConicalSeat) -> float:
    """Oil [m^3/s per m/s] that the gap takes in when the cone opens: pi (r_1,out^2 - r_1^2)."""
    g = gap(x, seat)
    outer = g.r1 + seat.length * seat.sine
    return math.pi * (outer**2 - g.r1**2)


def film_pressure(y: float, x: float, seat: ConicalSeat) -> float:
    """p [Pa per m/s of opening] at a distance y from the inlet: <= 0, zero at both ends."""
    g, middle = gap(x, seat), 0.5 * gap(x, seat).H * seat.cosine
    return _scale(g.H, seat) * _shape(g.rm + y * seat.sine, g.rm, g.rm + seat.length * seat.sine, middle)


def film_damping(x: float, seat: ConicalSeat) -> float:
    """K [N s/m] > 0 against an axial speed; about mu 2 pi r sin^2(a) L^3/H^3 in a narrow gap."""
    g, middle = gap(x, seat), 0.5 * gap(x, seat).H * seat.cosine
    a, b = g.rm, g.rm + seat.length * seat.sine
    inflow = _inflow(a, b, middle)

    def antiderivative(r: float) -> float:
        """Of the shape times (r - middle)."""
        s, d = r - a, r + a
        logarithm = math.log(r / a)
        by_log = 0.5 * r**2 * logarithm - 0.25 * s * d - middle * (r * logarithm - s)
        square = 0.5 * (0.25 * r**4 - 0.5 * a**2 * r**2 - middle * (r**3 / 3.0 - a**2 * r))
        line = 2.0 * middle * (r**3 / 3.0 - 0.5 * a * r**2 - middle * (0.5 * r**2 - a * r))
        return inflow * by_log - math.pi * (square - line)

    return -2.0 * math.pi * _scale(g.H, seat) * (antiderivative(b) - antiderivative(a))


def narrow_film_damping(x: float, seat: ConicalSeat) -> float:
    """The same [N s/m] for a gap without curvature, of the cone's mean radius."""
    g = gap(x, seat)
    mean = g.r1 + 0.5 * seat.length * seat.sine
    return 2.0 * math.pi * seat.viscosity * mean * seat.sine**2 * (seat.length / g.H) ** 3


def _scale(H: float, seat: ConicalSeat) -> float:
    return -6.0 * seat.viscosity / (math.pi * H**3 * seat.sine)


def _inflow(a: float, b: float, middle: float) -> float:
    """What makes the pressure zero at the outlet, radii a .. b of the middle of the gap [m^3/s per m/s]."""
    return math.pi * (0.5 * (b**2 - a**2) - 2.0 * middle * (b - a)) / math.log(b / a)


def _shape(r: float, a: float, b: float, middle: float) -> float:
    parabola = 0.5 * (r**2 - a**2) - 2.0 * middle * (r - a)
    return _inflow(a, b, middle) * math.log(r / a) - math.pi * parabola
