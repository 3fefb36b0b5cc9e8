"""Where the swing grows so large that it just touches the seat: the end of smooth orbits, the beginning of impacts."""

import numpy as np

from twin.chatter.equilibrium import onset
from twin.chatter.orbit import Orbit, follow, small, small_of_flow
from twin.chatter.system import CONICAL, System

DEPTHS = np.array([0.02, 0.05, *np.linspace(0.1, 1.0, 19)])


def grazing_damping(s: System) -> Orbit:
    """The orbit that touches the seat at the system's flow, with the damping k that has it.

    Raises ValueError where the orbits turn back before they reach the seat.
    """
    return follow(small(s, float(DEPTHS[0])), DEPTHS, "damping")[-1]


def grazing_flow(s: System) -> Orbit:
    """The orbit that touches the seat at the system's damping, with its flow q. Raises ValueError as above."""
    return follow(small_of_flow(s, float(DEPTHS[0])), DEPTHS, "flow")[-1]


def averaged_grazing(s: System) -> tuple[float, float]:
    """Flow q and mean lift m of the conical seat's grazing orbit, by averaging: small z, a harmonic lift m (1 + cos t).

    Per turn the oil gives `beta y3 (3 m^2 + 3/4 a^2)` and the damper takes k; the mean flow is `y3 m (m^2 + 3/2 a^2)`,
    y3 = m + e. At a = m: k = 15/4 beta (m + e) m^2, q = 5/2 (m + e) m^3; without precompression
    q = 5/2 (4 k/(15 beta))^(4/3). For the chamfered seat k and q do not depend on the amplitude in this order.
    """
    if s.law != CONICAL:
        raise ValueError("only the conical seat has a grazing flow by averaging: take grazing_flow")
    target = s.damping / (3.75 * s.beta)
    roots = np.roots([1.0, s.precompression, 0.0, -target])
    m = float(roots[np.abs(roots.imag) < 1e-9 * np.abs(roots).max()].real.max())
    return 2.5 * (m + s.precompression) * m**3, m


def ratio_at_grazing(s: System) -> float:
    """Grazing damping over k_crit: how much is left between the first swing and the first impact."""
    return grazing_damping(s).system.damping / onset(s).damping
