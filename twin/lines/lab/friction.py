"""Friction at the wall: laminar with memory (Zielke and what was made of him), Brunone's, quasi-steady.

    f(u) = beta u + c sum_j I_j(t),   I_j = m_j int_0^t exp(-n_j (t - s)/t_v) u_s ds,   beta = 8/t_v, c = 4/t_v

t_v = R^2/nu, (2.60) to (2.62); W(T) = sum m_j exp(-n_j T) stands for Zielke's weight sum_j exp(-z_j^2 T), J_2(z_j) = 0,
z_j^2 at `rates`. In (2.65) the thesis's exponents lack nu/R^2 and in (2.66) delta lacks rho a; both are right here.
Brunone and Vitkovsky: (k/2) (u_t + a sign(u) |u_x|), k = sqrt(C*)/2, C* = 0.00476 laminar ((2.53) prints 0.0476) and
7.41/Re^log10(14.3/Re^0.05) turbulent. Turbulent friction is the laminar one times `twin.lines.friction.turbulence`.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.special import jn_zeros

from twin.lines.friction import TURBULENT_LIMIT
from twin.lines.lab.pipe import Array
from twin.lines.mesh import friction_poles

LAMINAR_DECAY = 0.00476  # C*, Vardy's shear decay coefficient
SHORT_TIME = 0.02  # T below which the short-time series of W is used
SHORT_SERIES = (0.282095, -1.25, 1.057855, 0.9375, 0.396696, -0.351563)  # of T^-1/2, 1, T^1/2, ..; Zielke 1968
ZEROS = jn_zeros(2, 12)  # enough for T >= SHORT_TIME: exp(-z_12^2 T) = 1e-14
TRIKHA = ((40.0, 8.1, 1.0), (8000.0, 200.0, 26.4))  # m_j, n_j; Trikha 1975
SCHOHL = ((1.051, 2.358, 9.021, 29.47, 79.55), (26.65, 100.0, 669.6, 6497.0, 57990.0))  # Schohl 1993
KAGAWA = (  # Kagawa et al. 1983
    (1.0, 1.16725, 2.20064, 3.92861, 6.78788, 11.6761, 20.0612, 34.4541, 59.1642, 101.590),
    (26.3744, 72.8033, 187.424, 536.626, 1570.60, 4618.13, 13601.1, 40082.5, 118153.0, 348316.0),
)
NAMES = ("none", "steady", "quasi-steady", "brunone", "zielke", "trikha", "kagawa", "schohl", "fit", "convolution")


class Friction(NamedTuple):
    """A friction model, independent of the pipe but for `fit` and `brunone`."""

    name: str  # of NAMES
    steady: float  # 1 with Hagen-Poiseuille friction, 0 without
    turbulent: bool  # whether the steady part knows Re
    weights: Array  # m_j
    rates: Array  # n_j, over R^2/nu
    brunone: float  # k
    convolved: bool  # the whole memory, sum by sum

    @property
    def linear(self) -> bool:
        """Whether the line stays linear."""
        return not self.turbulent and self.brunone == 0.0


def friction(name: str, poles: int = 100, viscous_time: float = 0.0, step: float = 0.0, reynolds: float = 0.0):
    """A model by its name.

    poles: true poles of `zielke`. viscous_time, step [s]: `fit` takes 8 exponentials for memories from 0.7 steps on.
    reynolds: of the undisturbed flow, for `brunone` (laminar below 4000). ValueError: no such model, or no step.
    """
    none = np.zeros(0)
    if name not in NAMES:
        raise ValueError(f"friction {name!r} unknown; known: {', '.join(NAMES)}")
    bare = Friction(name, float(name != "none"), name in ("quasi-steady", "brunone"), none, none, 0.0, False)
    if name == "zielke":
        return bare._replace(weights=np.ones(poles), rates=jn_zeros(2, poles) ** 2)
    if name == "fit":
        weights, rates = _fitted(viscous_time, step)
        return bare._replace(weights=weights, rates=rates)
    published = {"trikha": TRIKHA, "kagawa": KAGAWA, "schohl": SCHOHL}
    if name in published:
        return bare._replace(weights=np.array(published[name][0]), rates=np.array(published[name][1]))
    return bare._replace(brunone=shear_decay(reynolds) if name == "brunone" else 0.0, convolved=name == "convolution")


def shear_decay(reynolds: float) -> float:
    """Brunone's k of the undisturbed flow, by Vardy and Brown."""
    if reynolds < TURBULENT_LIMIT:
        return math.sqrt(LAMINAR_DECAY) / 2.0
    return math.sqrt(7.41 / reynolds ** math.log10(14.3 / reynolds**0.05)) / 2.0


def _fitted(viscous_time: float, step: float) -> tuple[Array, Array]:
    """m_j and n_j from the filter p_j, r_j of the rig's `nodes`: r = 4 m (1 - p)/alpha, p = exp(-alpha)."""
    if not (viscous_time > 0.0 and step > 0.0):
        raise ValueError(f"friction fit needs a pipe and a step, got R^2/nu {viscous_time} s and step {step} s")
    p, r = friction_poles(viscous_time, "unsteady", step)
    p, r = p[r > 0.0], r[r > 0.0]
    alpha = -np.log(p)
    return r * alpha / (4.0 * (1.0 - p)), alpha * viscous_time / step


def weight(times: Array) -> Array:
    """Zielke's W at T = nu t/R^2 > 0: the short-time series below 0.02 (to 1e-5), else the poles."""
    t = np.asarray(times, float)
    short = sum(f * t ** (0.5 * k - 0.5) for k, f in enumerate(SHORT_SERIES))
    return np.where(t < SHORT_TIME, short, np.exp(-np.multiply.outer(t, ZEROS**2)).sum(axis=-1))


def weight_integral(times: Array) -> Array:
    """int_0^T W."""

    def early(t: Array) -> Array:
        return np.asarray(sum(f * t ** (0.5 * k + 0.5) / (0.5 * k + 0.5) for k, f in enumerate(SHORT_SERIES)))

    t = np.asarray(times, float)
    held = np.minimum(t, SHORT_TIME)
    decay = np.exp(-np.multiply.outer(held, ZEROS**2)) - np.exp(-np.multiply.outer(t, ZEROS**2))
    return early(held) + (decay / ZEROS**2).sum(axis=-1)


def approximate_weight(model: Friction, times: Array) -> Array:
    """W as a model has it."""
    return np.exp(-np.multiply.outer(np.asarray(times, float), model.rates)) @ model.weights


def recursion(model: Friction, viscous_time: float, step: float) -> tuple[Array, Array]:
    """Decay and gain of I_j <- decay I_j + gain (u - u_before): exact where u is straight within the step [s]."""
    alpha = model.rates * step / viscous_time
    return np.exp(-alpha), -model.weights * np.expm1(-alpha) / alpha


def convolution_weights(viscous_time: float, step: float, count: int) -> Array:
    """Means of W over steps 0..count-1 back [s], for changes of u that are straight within a step."""
    edges = weight_integral(np.arange(count + 1) * step / viscous_time)
    return np.diff(edges) * viscous_time / step
