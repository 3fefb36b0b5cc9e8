"""Where the seats' laws hold, and a plain word where they do not.

Chamfered: the loss coefficient (2.26) is fitted to lifts of 0.01 to 0.1 diameters. Conical: laminar up to
Re = Q/(pi r nu) = 2500 (Urata, after 3.1 of the thesis); inertia is left out, so Re H/L must be small; and the gap must
be narrow against seat and radius. The limits 1 and 0.1 of the last two are assumed.
"""

import math
from typing import NamedTuple

from twin.seats import chamfered, conical

SMALLEST_LIFT, LARGEST_LIFT = 0.01, 0.1  # x/d_in of the fit (2.26)
TURBULENT = 2500.0  # Re
INERTIA = 1.0  # Re H/L
NARROW = 0.1  # H/L and H/r


class Validity(NamedTuple):
    """A law at a point."""

    numbers: dict[str, float]  # what was looked at
    warnings: tuple[str, ...]  # none: it holds


def of_chamfered(x: float, seat: chamfered.ChamferedSeat) -> Validity:
    """The loss law at a lift x [m]."""
    ratio, said = x / seat.diameter, ()
    if not SMALLEST_LIFT <= ratio <= LARGEST_LIFT:
        low, high = SMALLEST_LIFT * seat.diameter * 1e3, LARGEST_LIFT * seat.diameter * 1e3
        said = (
            f"lift {x * 1e3:.4g} mm is {ratio:.2g} diameters: the loss law (2.26) is fitted to {SMALLEST_LIFT} .. "
            f"{LARGEST_LIFT} ({low:.3g} .. {high:.3g} mm) and is extrapolated here",
        )
    return Validity({"x/d": ratio}, said)


def of_conical(x: float, drop: float, density: float, seat: conical.ConicalSeat) -> Validity:
    """The laminar law at a lift x [m] and a drop [Pa]."""
    g = conical.gap(x, seat)
    reynolds = abs(conical.flow(x, drop, 0.0, seat)) * density / (math.pi * seat.radius * seat.viscosity)
    numbers = {"Re": reynolds, "Re H/L": reynolds * g.H / seat.length, "H/L": g.H / seat.length, "H/r": g.H / g.rm}
    said = []
    if reynolds > TURBULENT:
        said.append(f"Re = {reynolds:.0f} is above {TURBULENT:.0f}, where the gap turns turbulent: less flow than said")
    if numbers["Re H/L"] > INERTIA:
        said.append(
            f"Re H/L = {numbers['Re H/L']:.2g} is above {INERTIA:g}: the jet's inertia, which is left out, takes a "
            "share of the drop; take a smaller lift or drop, or a longer seat"
        )
    wide = [name for name in ("H/L", "H/r") if numbers[name] > NARROW]
    said += [f"{name} = {numbers[name]:.2g} is above {NARROW:g}: the gap is not narrow" for name in wide]
    return Validity(numbers, tuple(said))
