"""The dimensionless actuator: symmetric cylinder between constant supply and relief, square-root valve.

Source: chapter 5, (5.7), (5.8), (5.10). y = (x/L, x'/(L omega), two chamber pressures between relief 0 and supply 1);
time in 1/omega. A valve signal u opens supply to chamber 3 and chamber 4 to relief when u > 0, the other way when
u < 0. Its openings are a = max(u, 0), b = max(-u, 0); both are open at once only in the smoothed relay.

The root has an infinite slope at no pressure drop. Beyond 0 and 1 its sign lets the flow reverse: a chamber that is
squeezed above the supply gives oil back. A vapour pressure is not in this model. `laminar` > 0 replaces the root below
that drop by a line, as in a real edge, so that its slope stays finite; 0.0 is the pure root.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from twin.kernel import inlined

Array = npt.NDArray[np.floating]


class Actuator(NamedTuple):
    """Dimensionless physical parameters."""

    alpha: float  # (p_s - p_r)/B
    gamma: float  # Q_max/(V0 omega)
    k: float  # K/(m omega); printed K/(m L omega^2), which has a dimension


class Feedback(NamedTuple):
    """Dimensionless gains of h = s y1 + d y2."""

    s: float  # S L
    d: float  # D L omega


class Drive(NamedTuple):
    """A symmetric drive in SI units, as in Table 5.1."""

    mass: float  # m [kg]
    area: float  # A [m^2]
    length: float  # L [m], of one chamber with the piston in its place
    modulus: float  # B [Pa]
    supply: float  # p_s [Pa]
    relief: float  # p_r [Pa]
    flow: float  # Q_max [m^3/s], of the open valve at p_s - p_r
    friction: float  # K [N s/m], slope of the friction force


TABLE_5_1 = Drive(200.0, 1.32e-3, 0.4, 1.125e9, 70e5, 1e5, 30.0 / 60e3, 0.0)


def omega(drive: Drive) -> float:
    """Unit of frequency [rad/s]: one chamber as a spring, sqrt(A B/(L m))."""
    return math.sqrt(drive.area * drive.modulus / (drive.length * drive.mass))


def dimensionless(drive: Drive) -> Actuator:
    """The parameters of a drive. Table 5.1 gives gamma 6.95e-3: the printed 2.78e-3, and the 0.23 and 0.5 of the
    figures, belong to other rigs. ValueError for a value that no drive has."""
    for name, value in drive._asdict().items():
        least = 0.0 if name in ("friction", "relief") else math.ulp(0.0)
        if not least <= value < math.inf:
            raise ValueError(f"{name} {value} must be finite and {'at least' if least == 0.0 else 'above'} 0")
    if drive.supply <= drive.relief:
        raise ValueError(f"supply {drive.supply} Pa must be above relief {drive.relief} Pa")
    gamma = drive.flow / (drive.area * drive.length * omega(drive))
    return Actuator((drive.supply - drive.relief) / drive.modulus, gamma, drive.friction / (drive.mass * omega(drive)))


@inlined
def root(drop: float, laminar: float) -> float:
    """G: sqrt|r| sign r, or r/(r^2 + laminar^2)^(1/4), which is that far from r = 0."""
    if laminar == 0.0:
        return math.copysign(math.sqrt(abs(drop)), drop)
    return drop / math.sqrt(math.sqrt(drop * drop + laminar * laminar))


@inlined
def root_slope(drop: float, laminar: float) -> float:
    """G'; infinite at drop 0.0 of the pure root."""
    square = drop * drop + laminar * laminar
    if laminar == 0.0:
        return 0.5 / math.sqrt(abs(drop))
    return (0.5 * drop * drop + laminar * laminar) / (square * math.sqrt(math.sqrt(square)))


@inlined
def flows(y3: float, y4: float, a: float, b: float, laminar: float) -> tuple[float, float]:
    """q1, q2: flow into the chambers at the openings a, b >= 0."""
    q1 = a * root(1.0 - y3, laminar) - b * root(y3, laminar)
    return q1, b * root(1.0 - y4, laminar) - a * root(y4, laminar)


@inlined
def rates(
    y1: float, y2: float, y3: float, y4: float, a: float, b: float, actuator: Actuator, laminar: float
) -> tuple[float, float, float, float]:
    """y', (5.7), at the openings a, b >= 0; |y1| < 1."""
    alpha, gamma, k = actuator
    q1, q2 = flows(y3, y4, a, b, laminar)
    rate3 = (gamma * q1 - y2) / (alpha * (1.0 + y1))
    return y2, alpha * (y3 - y4) - k * y2, rate3, (gamma * q2 + y2) / (alpha * (1.0 - y1))


def field(y: Array, u: Array | float, actuator: Actuator) -> Array:
    """y' of many states at once: y (..., 4), u (...) -> (..., 4); the pure root."""
    y1, y2, y3, y4 = np.moveaxis(np.asarray(y, float), -1, 0)
    a, b = np.maximum(u, 0.0), np.maximum(-np.asarray(u), 0.0)
    of_supply, of_relief = (_root(1.0 - y3), _root(1.0 - y4)), (_root(y3), _root(y4))
    q1, q2 = a * of_supply[0] - b * of_relief[0], b * of_supply[1] - a * of_relief[1]
    rate3 = (actuator.gamma * q1 - y2) / (actuator.alpha * (1.0 + y1))
    rate4 = (actuator.gamma * q2 + y2) / (actuator.alpha * (1.0 - y1))
    return np.stack([y2, actuator.alpha * (y3 - y4) - actuator.k * y2, rate3, rate4], axis=-1)


def _root(drop: Array) -> Array:
    return np.sign(drop) * np.sqrt(np.abs(drop))


def linearise(actuator: Actuator, p_e: float) -> tuple[Array, Array, Array]:
    """A (4, 4) and the columns B (4,) for u > 0 and for u < 0, at rest with y3 = y4 = p_e, 0 < p_e < 1.

    The field has a kink at u = 0; the two columns differ by what moves y3 + y4, and both move y3 - y4 by
    gamma/alpha (sqrt(p_e) + sqrt(1 - p_e)).
    """
    if not 0.0 < p_e < 1.0:
        raise ValueError(
            f"p_e {p_e} must lie between relief 0 and supply 1, both excluded: the root is not smooth there"
        )
    alpha, gamma, k = actuator
    low, high = gamma / alpha * math.sqrt(p_e), gamma / alpha * math.sqrt(1.0 - p_e)
    a = np.array([[0, 1, 0, 0], [0, -k, alpha, -alpha], [0, -1 / alpha, 0, 0], [0, 1 / alpha, 0, 0]], float)
    return a, np.array([0.0, 0.0, high, -low]), np.array([0.0, 0.0, low, -high])


def mirror(y: Array) -> Array:
    """The same motion seen from the other side: (-y1, -y2, y4, y3), with -u. y (..., 4)."""
    y = np.asarray(y, float)
    return np.stack([-y[..., 0], -y[..., 1], y[..., 3], y[..., 2]], axis=-1)
