"""Three models of the viscous force on a cone, each as a part by pressure and a part by speed.

Source: 3.4 of the thesis, corrected: an equivalent cylinder (3.18) to (3.24), the conical gap (3.25) to (3.32), and the
diverging channel (3.35) to (3.49). All give the force along the gap, downstream positive; its axial part is cos a times
it. `wall` is the cone's speed along the gap, > 0 downstream.

In the channel the drop and the wall's speed cannot be chosen apart: (3.46) has one solution for a wall's speed, and the
drop that belongs to it comes out. Its shear F''(0) is -G/2 by the pressure gradient, as in any plane channel, and the
rest by the wall.
"""

import math
from typing import NamedTuple

import numpy as np

from twin.seats.conical import ConicalSeat, gap, shear_force
from twin.seats.cylinder import cylinder_force
from twin.seats.diverging import solve

PLACES = 8  # of Gauss and Legendre along the seat: the shear varies by R, a few parts in a hundred


class Parts(NamedTuple):
    """A force in two parts."""

    by_pressure: float  # [N]
    by_speed: float  # [N]

    @property
    def total(self) -> float:
        """Their sum [N]."""
        return self.by_pressure + self.by_speed


class Channel(NamedTuple):
    """The force of the diverging channel and the drop that it needs."""

    force: Parts
    drop: float  # p_in - p_out [Pa]


def mean_radius(x: float, seat: ConicalSeat) -> float:
    """Radius [m] of the cone in the middle of the seat."""
    return gap(x, seat).r1 + 0.5 * seat.length * seat.sine


def by_cylinder(x: float, drop: float, wall: float, seat: ConicalSeat, radius: float | None = None) -> Parts:
    """An equivalent cylinder of a radius [m], else of the thesis's, the cone's at the inlet."""
    g = gap(x, seat)
    radius = radius or g.r1
    apart = ((drop, 0.0), (0.0, wall))
    return Parts(*(cylinder_force(radius, g.H, seat.length, dp, v, seat.viscosity) for dp, v in apart))


def by_cone(x: float, drop: float, wall: float, seat: ConicalSeat) -> Parts:
    """The conical gap, exact."""
    return Parts(shear_force(x, drop, 0.0, seat), shear_force(x, 0.0, wall, seat))


def by_channel(x: float, wall: float, density: float, seat: ConicalSeat, normal: float = 0.0) -> Channel:
    """The diverging channel, (3.49): the shear of (3.46) at places along the seat, integrated over the cone.

    normal: F(0) of (3.47); 0 for a wall that slides only. ValueError: no flow found, as `diverging.solve`.
    """
    g = gap(x, seat)
    nodes, weights = np.polynomial.legendre.leggauss(PLACES)
    total = np.zeros(3)
    for s, weight in zip(0.5 * seat.length * (1.0 + nodes), 0.5 * seat.length * weights, strict=True):
        reynolds = wall * g.H**2 * density / (seat.viscosity * (g.w + s))
        found = solve(float(reynolds), normal)
        shear, around = seat.viscosity * wall / g.H, 2.0 * math.pi * (g.r1 + s * seat.sine)
        pushed = -0.5 * found.gradient
        total += weight * shear * np.array([around * pushed, around * (found.shear - pushed), -found.gradient / g.H])
    return Channel(Parts(float(total[0]), float(total[1])), float(total[2]))
