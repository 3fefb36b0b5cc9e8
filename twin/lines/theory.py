"""The exact laminar line in Laplace's s, normalised: what the models are fitted to.

Symbols: T = l/a travel time, t_v = R^2/nu, u = s T, sigma = s t_v, xi = sqrt(sigma), Z0 = rho a/A; losses N(s):
`none` 1, steady 1 + 8/sigma (Hagen-Poiseuille), unsteady I0(xi)/I2(xi) (dissipative laminar flow).
Zc = Z0 sqrt(N), Gamma l = u sqrt(N). Scattered against Z0, a = p + Z0 q, b = p - Z0 q, q into the line, the line
equal at both ends splits into two modes: both ends alike (+), b = S+ a, and opposite (-), b = S- a, with

    S+ = (n coth(g/2) - 1)/(n coth(g/2) + 1),    S- = (n tanh(g/2) - 1)/(n tanh(g/2) + 1),    n = sqrt(N), g = u n.

Both are even in n: no branch point, smooth at s = 0. Passive means |S+|, |S-| <= 1.

A wall of Kelvin-Voigt elements has a compliance that depends on s: over that which oil and wall have at once,

    W(s) = 1 + sum w_k/(1 + s tau_k),      n = sqrt(N/W), g = u sqrt(N W)      (Suo and Wylie 1990)
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.lines.spec import Creep

Complex = Any  # NDArray[complex128], which numpy's own annotations lose on the way
LOSSES = ("none", "steady", "unsteady")


class Line(NamedTuple):
    """A line on the grid of a step."""

    travel_time: float  # T [s]
    viscous_time: float  # t_v = R^2/nu [s]
    losses: str  # of LOSSES
    step: float  # h [s]
    creep: tuple[Creep, ...] = ()  # of its wall

    @property
    def steps(self) -> float:
        """M = T/h."""
        return self.travel_time / self.step

    @property
    def dissipation(self) -> float:
        """Dn = T/t_v."""
        return self.travel_time / self.viscous_time


def losses(s: Complex, viscous_time: float, kind: str) -> Complex:
    """N(s), s != 0."""
    if kind == "none":
        return np.ones_like(s)
    sigma = s * viscous_time
    if kind == "steady":
        return 1.0 + 8.0 / sigma
    from scipy.special import ive

    xi = np.sqrt(sigma)
    return ive(0, xi) / ive(2, xi)


def compliance(s: Complex, creep: tuple[Creep, ...]) -> Complex:
    """W(s) of a wall that creeps."""
    return 1.0 + sum(element.share / (1.0 + s * element.time) for element in creep)


def modes(
    s: Complex, travel_time: float, viscous_time: float, kind: str, creep: tuple[Creep, ...] = ()
) -> tuple[Complex, Complex]:
    """S+ and S- of the line."""
    n = np.sqrt(losses(s, viscous_time, kind))
    e = np.exp(-s * travel_time * n)
    if creep:
        root = np.sqrt(compliance(s, creep))
        n, e = n / root, np.exp(-s * travel_time * n * root)
    rest, through = n * (1.0 + e), n * (1.0 - e)
    return (rest - (1.0 - e)) / (rest + (1.0 - e)), (through - (1.0 + e)) / (through + (1.0 + e))


def slow_plus(line: Line) -> NDArray[np.float64]:
    """Coefficients of 1, u, u^2, u^3 of S+ about s = 0.

    u N = w = 8 Dn + w1 u + ..., w1 = 4/3 unsteady, 1 else; S+ = 1 - 2u/(y + u),
    y = g coth(g/2) = 2 + u w/6 - (u w)^2/360 + ...  The second coefficient says that the line holds T/Z0 = V/B. With
    creep u w becomes u w W, and S+ = 1 - 2 u W/(y + u W): it holds W(0) V/B.
    """
    kind = line.losses
    dn = 0.0 if kind == "none" else line.dissipation
    if line.creep:
        return _slow_creeping(np.array([8.0 * dn, 4.0 / 3.0 if kind == "unsteady" else 1.0, 0.0, 0.0]), line)
    y1 = 8.0 * dn / 6.0 + 1.0
    y2 = (4.0 / 3.0 if kind == "unsteady" else 1.0) / 6.0 - (8.0 * dn) ** 2 / 360.0
    return np.array([1.0, -1.0, 0.5 * y1, 0.5 * (y2 - 0.5 * y1**2)])


def _slow_creeping(w: NDArray[np.float64], line: Line) -> NDArray[np.float64]:
    """The same from the series of w and of u W."""
    late = [(element.share, -element.time / line.travel_time) for element in line.creep]
    store = np.array([0.0, *(float(k == 0) + sum(share * time**k for share, time in late) for k in range(3))])
    square = np.convolve(store, w)[:4]
    below = np.array([2.0, 0.0, 0.0, 0.0]) + square / 6.0 - np.convolve(square, square)[:4] / 360.0 + store
    quotient = np.zeros(4)
    for k in range(4):
        quotient[k] = (store[k] - quotient[:k] @ below[k:0:-1]) / below[0]
    return np.array([1.0, 0.0, 0.0, 0.0]) - 2.0 * quotient


def slow_minus(dissipation: float, kind: str) -> float:
    """S- at s = 0: the steady resistance 8 Dn Z0."""
    r = 0.0 if kind == "none" else 4.0 * dissipation
    return (r - 1.0) / (r + 1.0)
