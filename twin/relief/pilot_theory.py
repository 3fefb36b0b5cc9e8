"""Linear theory of the relief valve with compressible oil before its pilot: when does it chatter, and how fast?

States x, x' of the poppet, p2, and X, X' of the spool while that is off its seat; inlet p = c - z Q, the end of lines.
`m x'' = a(x) p2 - s (x0 + x) - K(x) x'`, `C p2' = Q12(p - p2) + A X' - Q(x, p2) - A_in x'`. The thesis's network has
C = 0. A spool on its seat leaves the pilot alone, with orifices and volume upstream. A spool off its seat steadies p2
through orifice 3, laminar about rest: a damper forty times as soft as the supply.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.relief.channel import CompressibleOil, IncompressibleOil
from twin.relief.main_stage import main_opening, spool_drag
from twin.relief.network import Relief
from twin.relief.poppet import pilot_opening, poppet_drag
from twin.relief.steady import (
    pilot_flow,
    pilot_lift,
    pilot_pressure,
    rest,
)

Impedance = Callable[[complex], complex]


class Swing(NamedTuple):
    """The least damped oscillation at a point of rest."""

    lift: float  # of the poppet [m]
    pressure: float  # p2 [Pa]
    flow: float  # through the pilot [m^3/s]
    growth: float  # [1/s], > 0: it chatters
    frequency: float  # [Hz]


class _Slopes(NamedTuple):
    """Of the pilot at rest."""

    lift: float
    p2: float
    stiffness: float  # s - a' p2 [N/m]
    area: float  # a [m^2]
    by_lift: float  # dQ/dx [m^2/s]
    by_pressure: float  # dQ/dp2
    supply: float  # dQ12/d(p - p2)


def _slopes(pressure: float, valve: Relief) -> _Slopes:
    x, pilot, o = pilot_lift(pressure, valve), valve.pilot, valve.orifices
    if x <= 0.0:
        raise ValueError(f"the pilot is shut at {pressure:.0f} Pa: take a pressure above its cracking pressure")
    p2 = pilot_pressure(pressure, x, valve)
    dx, dp = 1e-5 * x, 1e-5 * p2
    area_slope = (pilot_opening(x + dx, pilot)[1] - pilot_opening(x - dx, pilot)[1]) / (2.0 * dx)
    return _Slopes(
        x,
        p2,
        pilot.stiffness - area_slope * p2,
        pilot_opening(x, pilot)[1],
        (pilot_flow(p2, x + dx, valve) - pilot_flow(p2, x - dx, valve)) / (2.0 * dx),
        (pilot_flow(p2 + dp, x, valve) - pilot_flow(p2 - dp, x, valve)) / (2.0 * dp),
        1.0 / (2.0 * o.a_12 * pilot_flow(p2, x, valve) + o.b_12),
    )


def valve_matrix(pressure: float, z: complex, valve: Relief) -> NDArray[Any]:
    """The Jacobian of (x, x', p2, X, X'), or of the first three with the spool shut, at an inlet pressure [Pa].

    z: impedance of the lines [Pa s/m^3], 0.0 for a constant pressure; complex at one s of Laplace's. Raises ValueError
    where the pilot is shut, or the oil before it incompressible.
    """
    if isinstance(valve.channel, IncompressibleOil):
        raise ValueError("the oil before the pilot is incompressible: take a relief.channel_volume above 0")
    matrix = balances(pressure, z, valve)
    matrix[2] /= valve.channel.capacity
    return matrix


def balances(pressure: float, z: complex, valve: Relief) -> NDArray[Any]:
    """The same, but its third row is what fills the oil before the pilot, C p2' [m^3/s]: C may be zero."""
    s, pilot, main = _slopes(pressure, valve), valve.pilot, valve.main
    spool = rest(pressure, valve).spool_lift
    seat, root = main_opening(spool, main), math.sqrt(pressure)
    through = seat.conductance / (2.0 * root)  # dQ_m/dp
    inlet = z / (1.0 + z * (through + s.supply))  # p falls by this times what more is drawn
    by_p2, by_spool, by_speed = inlet * s.supply, -inlet * seat.conductance_slope * root, -inlet * main.area
    g = s.supply
    matrix = np.zeros((5, 5), type(z))
    matrix[0, 1] = matrix[3, 4] = 1.0
    drag = poppet_drag(s.lift, pilot)
    matrix[1, :3] = -s.stiffness / pilot.mass, -drag / pilot.mass, s.area / pilot.mass
    matrix[2] = (
        -s.by_lift, -pilot.area, g * (by_p2 - 1.0) - s.by_pressure, g * by_spool, g * by_speed + main.area,
    )  # fmt: skip
    stiff = main.stiffness - seat.area_slope * pressure
    slow = main.area**2 * valve.orifices.b_3 + spool_drag(root, main)
    matrix[4] = (
        0.0, 0.0, seat.area * by_p2 - main.area, seat.area * by_spool - stiff, seat.area * by_speed - slow,
    )  # fmt: skip
    matrix[4] /= main.mass
    return matrix if spool > 0.0 else matrix[:3, :3]


def swing(pressure: float, z: float, valve: Relief) -> Swing:
    """Growth and frequency of the least damped oscillation above 300 Hz, the pilot's. Raises ValueError as above."""
    values = np.linalg.eigvals(valve_matrix(pressure, z, valve))
    fast = values[values.imag > 2.0 * math.pi * 300.0]
    least = fast[fast.real.argmax()] if len(fast) else values[values.real.argmax()]
    s = _slopes(pressure, valve)
    flow = pilot_flow(s.p2, s.lift, valve)
    return Swing(s.lift, s.p2, flow, float(least.real), float(least.imag) / (2.0 * math.pi))


def swings_with_lines(pressure: float, impedance: Impedance, valve: Relief) -> list[tuple[float, float]]:
    """Growth [1/s] and frequency [Hz] of the oscillations between 1 and 3 kHz, the fastest growing first.

    impedance: Z(s) [Pa s/m^3] of the lines at the inlet. Roots of det(s - M(Z(s))) by the secant rule from a start
    every 20 Hz: the lines' own modes are among them, and which of them the pilot takes up is theirs to decide.
    """
    capacity = valve.channel.capacity if isinstance(valve.channel, CompressibleOil) else 0.0
    still = balances(pressure, 0.0, valve)
    inertia = np.diag([1.0, 1.0, capacity, 1.0, 1.0][: len(still)])
    scale = 1.0 / np.abs(still).max(axis=1, keepdims=True)

    def characteristic(s: complex) -> complex:
        return complex(np.linalg.det((s * inertia - balances(pressure, complex(impedance(s)), valve)) * scale))

    found: list[complex] = []
    for start in 2.0 * math.pi * np.arange(1000.0, 3000.0, 20.0):
        root = _root(characteristic, 1j * float(start))
        known = any(abs(root - other) < 1e-3 * abs(other) for other in found) if root is not None else True
        if root is not None and not known and 1000.0 < root.imag / (2.0 * math.pi) < 3000.0:
            found.append(root)
    return sorted(((s.real, s.imag / (2.0 * math.pi)) for s in found), reverse=True)


def _root(function: Callable[[complex], complex], start: complex) -> complex | None:
    a, b = start, start * (1.0 + 1e-4) + 1.0
    f_a, f_b = function(a), function(b)
    for _ in range(40):
        if f_a == f_b:
            return None
        a, b, f_a = b, b - f_b * (b - a) / (f_b - f_a), f_b
        if not abs(b) < 1e6:
            return None
        f_b = function(b)
        if abs(b - a) < 1e-9 * abs(b):
            return b
    return None


def chatter_volumes(pressure: float, z: float, modulus: float, valve: Relief) -> tuple[float, float] | None:
    """Least and greatest volume [m^3] of oil of a modulus [Pa] with which the valve chatters; None: with none.

    Looked for from 1e-9 to 1e-2 m^3, twenty a decade, then bisected.
    """
    volumes = np.geomspace(1e-9, 1e-2, 141)

    def growth(volume: float) -> float:
        return swing(pressure, z, valve._replace(channel=CompressibleOil(volume / modulus))).growth

    sings = np.flatnonzero([growth(float(v)) > 0.0 for v in volumes])
    if not len(sings):
        return None
    first, last = int(sings[0]), int(sings[-1])
    low = _edge(growth, float(volumes[max(first - 1, 0)]), float(volumes[first]))
    high = _edge(growth, float(volumes[min(last + 1, 140)]), float(volumes[last]))
    return low, high


def _edge(growth, calm: float, singing: float) -> float:
    for _ in range(60):
        middle = math.sqrt(calm * singing)
        calm, singing = (calm, middle) if growth(middle) > 0.0 else (middle, singing)
    return math.sqrt(calm * singing)
