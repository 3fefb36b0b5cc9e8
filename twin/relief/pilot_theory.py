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

Impedance = Callable[[NDArray[Any]], NDArray[Any]]
STARTS = 2.0 * math.pi * np.arange(1000.0, 3000.0, 20.0)  # [rad/s], of the search for roots


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


class Balances(NamedTuple):
    """The Jacobian of (x, x', p2, X, X') at rest, or of the first three with the spool shut; of p2 that of C p2'.

    In the third row stands what fills the oil before the pilot [m^3/s]: C may be zero. Lines of an impedance z add to
    it: the inlet's pressure falls by z/(1 + z conductance) times what the valve draws.
    """

    fixed: NDArray[Any]  # at a constant pressure
    by_inlet: NDArray[Any]  # what each balance gains by the inlet's pressure
    drawn: NDArray[Any]  # what the valve draws less by each state
    conductance: float  # dQ/dp of pilot and main seat, nothing moving [m^3/(s Pa)]

    def matrix(self, z: Any) -> NDArray[Any]:
        """At an impedance [Pa s/m^3], or at each of many: its last two axes are the matrix."""
        inlet = np.asarray(z / (1.0 + z * self.conductance))
        return self.fixed + inlet[..., None, None] * np.outer(self.by_inlet, self.drawn)


def balances(pressure: float, valve: Relief) -> Balances:
    """At an inlet pressure [Pa]. Raises ValueError where the pilot is shut."""
    s, pilot, main = _slopes(pressure, valve), valve.pilot, valve.main
    spool, root = rest(pressure, valve).spool_lift, math.sqrt(pressure)
    seat = main_opening(spool, main)
    drag = poppet_drag(s.lift, pilot)
    stiff = main.stiffness - seat.area_slope * pressure
    slow = main.area**2 * valve.orifices.b_3 + spool_drag(root, main)
    fixed = np.zeros((5, 5))
    fixed[0, 1] = fixed[3, 4] = 1.0
    fixed[1, :3] = -s.stiffness / pilot.mass, -drag / pilot.mass, s.area / pilot.mass
    fixed[2] = -s.by_lift, -pilot.area, -s.supply - s.by_pressure, 0.0, main.area
    fixed[4, 2:] = -main.area / main.mass, -stiff / main.mass, -slow / main.mass
    by_inlet = np.array([0.0, 0.0, s.supply, 0.0, seat.area / main.mass])
    drawn = np.array([0.0, 0.0, s.supply, -seat.conductance_slope * root, -main.area])
    size = 5 if spool > 0.0 else 3
    through = seat.conductance / (2.0 * root)  # dQ_m/dp
    return Balances(fixed[:size, :size], by_inlet[:size], drawn[:size], through + s.supply)


def valve_matrix(pressure: float, z: complex, valve: Relief) -> NDArray[Any]:
    """The Jacobian of (x, x', p2, X, X'), or of the first three with the spool shut, at an inlet pressure [Pa].

    z: impedance of the lines [Pa s/m^3], 0.0 for a constant pressure; complex at one s of Laplace's. Raises ValueError
    where the pilot is shut, or the oil before it incompressible.
    """
    if isinstance(valve.channel, IncompressibleOil):
        raise ValueError("the oil before the pilot is incompressible: take a relief.channel_volume above 0")
    matrix = balances(pressure, valve).matrix(z)
    matrix[2] /= valve.channel.capacity
    return matrix


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

    impedance: Z(s) [Pa s/m^3] of the lines at the inlet, for an array of s. Roots of det(s - M(Z(s))) by the secant
    rule from many STARTS: the lines' own modes are among them; which of them the pilot takes up is theirs to decide.
    """
    capacity = valve.channel.capacity if isinstance(valve.channel, CompressibleOil) else 0.0
    at = balances(pressure, valve)
    inertia = np.diag([1.0, 1.0, capacity, 1.0, 1.0][: len(at.fixed)])
    scale = 1.0 / np.abs(at.fixed).max(axis=1, keepdims=True)

    def characteristic(s: NDArray[Any]) -> NDArray[Any]:
        return np.linalg.det((s[:, None, None] * inertia - at.matrix(impedance(s))) * scale)

    found: list[complex] = []
    for root in roots(characteristic, 1j * STARTS):
        known = any(abs(root - other) < 1e-3 * abs(other) for other in found)
        if not known and STARTS[0] < root.imag < 2.0 * math.pi * 3000.0:
            found.append(complex(root))
    return sorted(((s.real, s.imag / (2.0 * math.pi)) for s in found), reverse=True)


def roots(function: Callable[[NDArray[Any]], NDArray[Any]], starts: NDArray[Any]) -> NDArray[Any]:
    """Where the secant rule converges from each start, to 1e-9 of the root; those that do not are left out."""
    a, b = starts, starts * (1.0 + 1e-4) + 1.0
    f_a, found = function(a), []
    for _ in range(40):
        f_b = function(b)
        with np.errstate(all="ignore"):
            then = b - f_b * (b - a) / (f_b - f_a)
            near, sound = np.abs(then - b) < 1e-9 * np.abs(then), np.abs(then) < 1e6
        found.append(then[near & sound])
        going = ~near & sound
        if not going.any():
            break
        a, b, f_a = b[going], then[going], f_b[going]
    return np.concatenate(found)


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
