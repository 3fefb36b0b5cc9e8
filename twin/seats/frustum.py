"""The narrowest passage between a cone and a sharp edge, which chamfered seats of pilot and main stage share."""

import math

from twin.kernel import inlined


@inlined
def frustum_area(lift: float, diameter: float, sine: float, cosine: float) -> float:
    """Smallest area [m^2] between a cone and a sharp edge, (2.20), (2.21): pi x sin a (d - x sin(2a)/2)."""
    return math.pi * lift * sine * (diameter - lift * sine * cosine)
