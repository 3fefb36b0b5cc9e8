"""What can be attached to an end of a coupled line: a given pressure, a wall, a valve, a chamber with a piston.

The laws are the rig's own: `twin/orifice.py` for the valve, (2.11) with stored oil, as in `twin/cylinder.py`, for the
chamber.
"""

from collections.abc import Callable

import numpy as np

from twin.lines.lab.coupled import Attached
from twin.lines.lab.pipe import Array

NONE = np.zeros(0)
Course = Callable[[float], float]


def _still(t: float, z: Array, p: float, q: float) -> Array:
    return NONE


def given(pressure: Course) -> Attached:
    """A pressure [Pa] over time."""
    return Attached(NONE, NONE, _still, lambda t, z, p, q: p - pressure(t))


def wall(impedance: float) -> Attached:
    """A shut end; impedance: of the line, rho a/A [Pa s/m^3], which makes a pressure of its flow."""
    return Attached(NONE, NONE, _still, lambda t, z, p, q: impedance * q)


def valve(supply: Course, opening: Course, a: float, b: float, impedance: float) -> Attached:
    """A land from a supply [Pa]: (supply - p) y^2 = a Q|Q| + b y Q at an opening y, Q into the line, shut at y = 0.

    a, b: of the land fully open, `twin.orifice.resistance`.
    """

    def balance(t: float, z: Array, p: float, q: float) -> float:
        y = opening(t)
        least = 1e-6 * impedance  # where it is shut, the flow alone is left of the balance
        drop = a * q * abs(q) + (b * y + least) * q
        return (supply(t) - p) * y**2 + drop if y < 1e-3 else supply(t) - p + drop / y**2

    return Attached(NONE, NONE, _still, balance)


def chamber(
    area: float, dead: float, modulus: float, mass: float, push: Course, leak: Callable[[float, float], float],
    position: float, pressure: float, tolerated: tuple[float, float, float],
) -> Attached:  # fmt: skip
    """A chamber [m^2, m^3, Pa] that lifts a mass [kg]; z = stored oil [m^3], position [m], speed [m/s].

    push: every other force upwards [N]; leak: flow out of the chamber [m^3/s] at t and its pressure [Pa].
    """

    def rates(t: float, z: Array, p: float, q: float) -> Array:
        return np.array([q - leak(t, p), z[2], (area * p + push(t)) / mass])

    def balance(t: float, z: Array, p: float, q: float) -> float:
        return p - modulus * (z[0] / (dead + area * z[1]) - 1.0)

    stored = (dead + area * position) * (1.0 + pressure / modulus)
    return Attached(np.array([stored, position, 0.0]), np.array(tolerated), rates, balance)
