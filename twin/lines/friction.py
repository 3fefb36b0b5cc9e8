"""Steady friction in a round pipe: laminar, transition, turbulent.

Hagen-Poiseuille up to Re 2300; Blasius' law, 0.3164 Re^-1/4 against 64/Re, from Re 4000; linear in between
(assumed). Re = |q| 4/(pi d nu).
"""

import math

from twin.kernel import kernel

LAMINAR_LIMIT = 2300.0  # Re, Hagen-Poiseuille below
TURBULENT_LIMIT = 4000.0  # Re, Blasius above


@kernel
def turbulence(reynolds: float) -> float:
    """Friction over laminar friction: 1 up to Re 2300, Blasius 0.3164 Re^0.75/64 from Re 4000."""
    if reynolds <= LAMINAR_LIMIT:
        return 1.0
    root = math.sqrt(max(reynolds, TURBULENT_LIMIT))
    blasius = 0.3164 * root * math.sqrt(root) / 64.0  # Re^(3/4) of two roots: a tenth of the time of a power
    share = min(1.0, (reynolds - LAMINAR_LIMIT) / (TURBULENT_LIMIT - LAMINAR_LIMIT))
    return 1.0 + share * (blasius - 1.0)


@kernel
def turbulence_slope(reynolds: float) -> float:
    """Slope of the drop by the flow over that of laminar friction, d(Re turbulence)/dRe."""
    factor = turbulence(reynolds)
    if reynolds > TURBULENT_LIMIT:
        return 1.75 * factor
    if reynolds > LAMINAR_LIMIT:
        return factor + (factor - 1.0) * reynolds / (reynolds - LAMINAR_LIMIT)
    return factor
