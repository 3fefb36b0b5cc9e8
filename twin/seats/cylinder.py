"""A cylinder in a pipe: the simplest estimate of the viscous force on a cone, (3.18) to (3.24) of the thesis.

The drop is p_in - p_out throughout; the printed (3.24) has (H - 3 r_1)/4 where the limit of (3.23) has H.
"""

import math


def cylinder_force(radius: float, gap: float, length: float, drop: float, speed: float, viscosity: float) -> float:
    """Force [N] on a cylinder of a radius and length [m], downstream positive, (3.23): exact."""
    s = math.log1p(gap / radius)
    by_pressure = math.pi * drop * (-(radius**2) + gap / s * (radius + 0.5 * gap))
    return by_pressure - 2.0 * math.pi * viscosity * length * speed / s


def narrow_cylinder_force(
    radius: float, gap: float, length: float, drop: float, speed: float, viscosity: float
) -> float:
    """The same [N] in a narrow gap, (3.24) corrected."""
    return math.pi * radius * (drop * gap - 2.0 * viscosity * length * speed / gap)
