"""What the tests of the relief valve share: the rig's valve, and runs of it alone."""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from twin.kernel import allocating_kernel
from twin.oil import Oil
from twin.relief.motion import begin
from twin.relief.valve import (
    SHUT,
    Relief,
    ReliefState,
    relief,
    step_valve,
)

BAR, LITRE_PER_MINUTE = 1e5, 1e-3 / 60.0
IMPEDANCE = 5e9  # z [Pa s/m^3], about that of two pipes of 11 mm
FLOW, PRESSURE = 26.7 * LITRE_PER_MINUTE, 67 * BAR
PRECOMPRESSION = 0.18239343631460e-3  # [m], holds 67 bar at 26.7 l/min
SHEET_OIL = Oil(878.0, 40e-6, 1.17e9, -1e5)
SHEET = {
    "orifice_diameter": 0.6e-3,
    "orifice_discharge": 0.61,
    "orifice_transition": 9.33,
    "nozzle_diameter": 0.8e-3,
    "nozzle_discharge": 0.86,
    "nozzle_transition": 30.0,
    "seat_diameter": 5.6e-3,
    "cone_angle": math.radians(21.0),
    "loss_factor": 0.369,
    "loss_exponent": 2.3,
    "pilot_mass": 10.6e-3,
    "pilot_stiffness": 811e3,
    "pilot_precompression": PRECOMPRESSION,
    "pilot_travel": 6e-3,
    "pilot_restitution": 0.2,
    "pilot_spring_diameter": 13e-3,
    "pilot_spring_turns": 10.0,
    "spool_mass": 65.3e-3,
    "spool_diameter": 26e-3,
    "spool_angle": math.radians(45.0),
    "spool_length": 40e-3,
    "spool_gap": 0.1e-3,
    "spool_stiffness": 27.3e3,
    "spool_precompression": 5e-3,
    "spool_travel": 4e-3,
    "spool_restitution": 0.2,
    "spool_discharge": 0.61,
    "damping_length": 0.01,
    "rest_speed": 1e-4,
    "pilot_seat": "chamfered",
    "seat_length": 3.21e-3,
    "film_floor": 5e-6,
    "channel_volume": 0.0,
}


def valve(**numbers: float | str) -> Relief:
    """The rig's valve with some numbers in place of its own."""
    return relief(SHEET | numbers, SHEET_OIL)


@allocating_kernel
def follow(s: ReliefState, flow: float, c: np.ndarray, z: float, step: float, valve: Relief) -> np.ndarray:
    """Rows of state, Q, p and substeps after each step; c at the ends of the steps."""
    rows = np.empty((len(c) - 1, 7))
    m = begin(s, c[0] - z * flow, flow, valve, 0.0)
    for k in range(len(c) - 1):
        m, n = step_valve(m, c[k], c[k + 1], z, valve, step)
        rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3] = m.state
        rows[k, 4], rows[k, 5], rows[k, 6] = m.flow, c[k + 1] - z * m.flow, n
    return rows


def run(
    valve: Relief,
    c: Callable[[np.ndarray], np.ndarray],
    seconds: float,
    *,
    s: ReliefState = SHUT,
    flow: float = 0.0,
    z: float = IMPEDANCE,
    step: float = 50e-6,
) -> np.ndarray:
    """The rows of `follow` while c(t) acts."""
    return follow(s, flow, c(np.arange(round(seconds / step) + 1) * step), z, step, valve)


def steadily(c: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda t: np.full(t.shape, c)


def bracketed(function: Callable[[float], float], low: float, high: float) -> float:
    """The root between low and high, to rounding."""
    return float(brentq(function, low, high, xtol=1e-20, rtol=1e-15))  # pyright: ignore[reportArgumentType]
