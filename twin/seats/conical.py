"""Long conical seat: laminar flow between a cone and its housing, and what it does to the cone.

Symbols and signs: `twin/README.md`, after (3.1) to (3.32) of the thesis, corrected. y runs downstream along the
gap, h from the housing to the cone. The lift x is axial and opens; `wall` is the cone's speed along the gap, > 0
downstream: at an axial speed v it is v cos a, which the thesis takes as v. Oil that the cone displaces by widening the
gap is in `film.py`. Pressures in Pa, forces in N, > 0 opens.
"""

import math
from typing import NamedTuple


class ConicalSeat(NamedTuple):
    """Housing and oil; all functions need a lift > 0."""

    radius: float  # r_2 [m], of the housing at the inlet
    length: float  # L [m], along the gap
    angle: float  # a [rad], half the angle of the cone
    viscosity: float  # mu [Pa s]

    @property
    def sine(self) -> float:
        return math.sin(self.angle)

    @property
    def cosine(self) -> float:
        return math.cos(self.angle)


class Gap(NamedTuple):
    """A seat at a lift, in the thesis's symbols."""

    H: float  # height [m]
    r1: float  # radius of the cone at the inlet [m]
    rm: float  # radius of the middle of the gap at the inlet [m]
    w: float  # rm/sin a [m]
    z: float  # ln(rm/(rm + L sin a)) < 0, (3.8) at the outlet


def gap(x: float, seat: ConicalSeat) -> Gap:
    """The gap at a lift x > 0 [m]. Raises ValueError where there is none, or the cone would be thinner than nothing."""
    H = x * seat.sine
    r1 = seat.radius - H * seat.cosine
    if not x > 0.0 or r1 <= 0.0:
        most = seat.radius / (seat.sine * seat.cosine)
        raise ValueError(f"lift {x} m leaves no gap with a cone in it; take one above 0 and below {most:.4g} m")
    rm = seat.radius - 0.5 * H * seat.cosine
    return Gap(H, r1, rm, rm / seat.sine, -math.log1p(seat.length * seat.sine / rm))


def resistance_integral(y: float, g: Gap, seat: ConicalSeat) -> float:
    """F(y) [Pa s/m^3] of p = p_in + Q F - G, (3.6): the pressure that a unit of flow costs, < 0."""
    return -6.0 * seat.viscosity * math.log1p(y * seat.sine / g.rm) / (math.pi * seat.sine * g.H**3)


def drag_integral(y: float, wall: float, g: Gap, seat: ConicalSeat) -> float:
    """G(y) [Pa] of p = p_in + Q F - G, (3.7): what the moving cone drags along."""
    z = -math.log1p(y * seat.sine / g.rm)
    return -seat.viscosity * wall / g.H**2 * (6.0 * y + g.H * z * seat.cosine / seat.sine)


def flow(x: float, drop: float, wall: float, seat: ConicalSeat) -> float:
    """Q [m^3/s] at a pressure drop p_in - p_out, (3.2), (3.3)."""
    g = gap(x, seat)
    L = seat.length
    return (drag_integral(L, wall, g, seat) - drop) / resistance_integral(L, g, seat)


def power_flow(x: float, drop: float, exponent: float, seat: ConicalSeat) -> float:
    """Q [m^3/s] by (3.9), (3.11): exponent 3, the limit of small lifts, or 2.9, the thesis's fit to its CFD."""
    r = seat.radius
    length = math.log1p(seat.length * seat.sine / r)
    return math.pi * r**3 * seat.sine**4 * drop * (x / r) ** exponent / (6.0 * seat.viscosity * length)


def loss_coefficient(x: float, drop: float, density: float, seat: ConicalSeat) -> float:
    """zeta [-] of drop = zeta rho/2 (Q/A_in)^2, A_in = pi r_2^2; laminar, so it falls with the drop."""
    speed = flow(x, drop, 0.0, seat) / (math.pi * seat.radius**2)
    return drop / (0.5 * density * speed**2)


def pressure(y: float, x: float, p_in: float, p_out: float, wall: float, seat: ConicalSeat) -> float:
    """p [Pa] at a distance y from the inlet, 0 .. L, (3.3)."""
    g = gap(x, seat)
    q = flow(x, p_in - p_out, wall, seat)
    return p_in + q * resistance_integral(y, g, seat) - drag_integral(y, wall, g, seat)


def pressure_force(x: float, p_in: float, p_out: float, wall: float, seat: ConicalSeat) -> float:
    """Axial force [N] of the pressure, nose and seat less what p_out bears, (3.12) to (3.16) with -2 w^2 z in B."""
    g, L, sine = gap(x, seat), seat.length, seat.sine
    cot = seat.cosine / sine
    A = L * (1.0 + g.z) + g.w * g.z
    B = 0.25 * (-2.0 * L * g.w + L**2 * (1.0 + 2.0 * g.z) - 2.0 * g.w**2 * g.z)
    E = g.r1 * A + B * sine
    drag = wall * seat.viscosity / g.H**2
    integral = p_in * (L * g.r1 + 0.5 * sine * L**2) - (p_in - p_out) / g.z * E
    integral -= drag * (6.0 * L + g.H * g.z * cot) / g.z * E
    integral += drag * (g.r1 * (3.0 * L**2 + A * g.H * cot) + sine * (2.0 * L**3 + g.H * B * cot))
    return _between_ends(integral, g, p_in, p_out, seat)


def linear_pressure_force(x: float, p_in: float, p_out: float, seat: ConicalSeat) -> float:
    """The same [N] for a pressure that falls linearly along the gap, (3.17)."""
    g, L = gap(x, seat), seat.length
    integral = g.r1 * L * (p_in + p_out) / 2.0 + seat.sine * L**2 * (p_in + 2.0 * p_out) / 6.0
    return _between_ends(integral, g, p_in, p_out, seat)


def _between_ends(integral: float, g: Gap, p_in: float, p_out: float, seat: ConicalSeat) -> float:
    outer = g.r1 + seat.length * seat.sine
    return math.pi * (g.r1**2 * p_in - outer**2 * p_out) + 2.0 * math.pi * seat.sine * integral


def shear_force(x: float, drop: float, wall: float, seat: ConicalSeat) -> float:
    """Force [N] of the wall shear along the gap, downstream positive, (3.31); its axial part is cos a times it."""
    g, L = gap(x, seat), seat.length
    half, bent = 0.5 * g.H * seat.cosine, L * seat.sine / g.z
    by_pressure = math.pi * g.H * drop * (-half - bent)
    mean = g.r1 + 0.5 * L * seat.sine
    return by_pressure - math.pi * seat.viscosity * L * wall / g.H * (8.0 * mean + 6.0 * (half + bent))


def linear_shear_force(x: float, drop: float, wall: float, seat: ConicalSeat) -> float:
    """The same [N] for a pressure that falls linearly, (3.32)."""
    g, L = gap(x, seat), seat.length
    mean = g.r1 + 0.5 * L * seat.sine
    return math.pi * mean * (g.H * drop - 2.0 * seat.viscosity * L * wall / g.H)


def linearity(x: float, seat: ConicalSeat) -> tuple[float, float]:
    """K_p, K_v, (3.33), (3.34): exact over linear factor of the drop and of the speed in the shear force."""
    exact = shear_force(x, 1.0, 0.0, seat), shear_force(x, 0.0, 1.0, seat)
    plain = linear_shear_force(x, 1.0, 0.0, seat), linear_shear_force(x, 0.0, 1.0, seat)
    return exact[0] / plain[0], exact[1] / plain[1]


def shear_damping(x: float, seat: ConicalSeat) -> float:
    """K [N s/m] >= 0 against an axial speed, at a constant gap: shear, and the pressure of what the cone drags along.

    Both the wall's speed along the gap and the axial part of its force bring a factor cos a.
    """
    by_pressure = pressure_force(x, 0.0, 0.0, seat.cosine, seat)
    return -(by_pressure + seat.cosine * shear_force(x, 0.0, seat.cosine, seat))
