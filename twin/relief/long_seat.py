"""The long conical seat in the poppet's step: what `twin/seats/conical.py` and `film.py` say, compiled, per pressure.

With the outlet at zero, flow and forces are proportional to p2. The shut cone is pressed by the pressure that its gap
would have at a vanishing lift, so nothing jumps when it opens (assumed: it seals at the outlet's edge).
"""

import math
from typing import NamedTuple

from twin.kernel import kernel
from twin.relief.seat import is_laminar, laminar_conductance, opening_slope, pressure_stiffness, seat_damping, seat_flow


class LongSeat(NamedTuple):
    """Housing and oil."""

    radius: float  # r_2 [m]
    length: float  # L [m]
    viscosity: float  # mu [Pa s]
    sine: float  # sin alpha
    cosine: float  # cos alpha
    floor: float  # [m], lift below which damping grows no more: roughness


@kernel
def long_conductance(lift: float, seat: LongSeat) -> float:
    """G [m^3/(s Pa)] of Q = G p2, (3.2), (3.6)."""
    H = lift * seat.sine
    rm = seat.radius - 0.5 * H * seat.cosine
    return math.pi * seat.sine * H**3 / (6.0 * seat.viscosity * math.log1p(seat.length * seat.sine / rm))


@kernel
def long_area(lift: float, seat: LongSeat) -> float:
    """Area [m^2] on which p2 acts: pressure (3.12) and axial part of the shear (3.31), p_out = 0, the cone at rest."""
    L, sine, H = seat.length, seat.sine, lift * seat.sine
    r1, rm = seat.radius - H * seat.cosine, seat.radius - 0.5 * H * seat.cosine
    z, w = -math.log1p(L * sine / rm), rm / sine
    A = L * (1.0 + z) + w * z
    B = 0.25 * (-2.0 * L * w + L**2 * (1.0 + 2.0 * z) - 2.0 * w**2 * z)
    on_seat = L * r1 + 0.5 * sine * L**2 - (r1 * A + B * sine) / z
    shear = -math.pi * H * (0.5 * H * seat.cosine + L * sine / z)
    return math.pi * r1**2 + 2.0 * math.pi * sine * on_seat + seat.cosine * shear


@kernel
def long_damping(lift: float, seat: LongSeat) -> float:
    """K [N s/m] of squeeze film and of shear (narrow gap, mean radius: within 4 %), at no less than the floor."""
    lift = max(lift, seat.floor)
    L, sine, H = seat.length, seat.sine, lift * seat.sine
    middle, a = 0.5 * H * seat.cosine, seat.radius - 0.5 * H * seat.cosine
    b = a + L * sine
    inflow = math.pi * (0.5 * (b * b - a * a) - 2.0 * middle * (b - a)) / math.log(b / a)
    log, span = math.log(b / a), b - a
    by_log = 0.5 * b * b * log - 0.25 * span * (b + a) - middle * (b * log - span)
    cube, fourth, square = (b**3 - a**3) / 3.0, 0.25 * (b**4 - a**4), 0.5 * (b * b - a * a)
    parabola = 0.5 * (fourth - a * a * square - middle * (cube - a * a * span))
    line = 2.0 * middle * (cube - a * square - middle * (square - a * span))
    film = 12.0 * seat.viscosity / (H**3 * sine) * (inflow * by_log - math.pi * (parabola - line))
    mean = seat.radius - H * seat.cosine + 0.5 * L * sine
    return film + 2.0 * math.pi * seat.viscosity * mean * L * seat.cosine**2 / H


@seat_flow.register
def _(seat: LongSeat, lift: float) -> tuple[float, float]:
    return 0.0, long_area(lift, seat)


@opening_slope.register
def _(seat: LongSeat, lift: float, conductance: float, area: float) -> tuple[float, float]:
    return 0.0, 0.0


@laminar_conductance.register
def _(seat: LongSeat, lift: float) -> float:
    return long_conductance(lift, seat) if lift > 0.0 else 0.0


@is_laminar.register
def _(seat: LongSeat) -> bool:
    return True


@seat_damping.register
def _(seat: LongSeat, lift: float, spring: float) -> float:
    return spring + long_damping(lift, seat)


@pressure_stiffness.register
def _(seat: LongSeat, stiff_12: float, y: float, lift: float, conductance: float, area: float) -> float:
    return 0.0  # its film damps what the oil would swing
