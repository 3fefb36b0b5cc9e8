"""The sampled loop about a linear plant: hold, any delay, proportional gain and the three derivatives, as one matrix.

From sample to sample z -> M z with z the plant's states, the commands that have yet to act, and what the law remembers:
u_k = -P y_k - D v_k acts from t_k + delay and is held. M is affine in both gains. Stable if all multipliers, the
eigenvalues of M, lie inside the unit circle; what neither the controller moves nor the position shows may stay on it.
Units: whatever the plant has; of the rig P [1/m], D [s/m], times in s.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.stability.plant import Plant

NEUTRAL = 1e-7  # above the unit circle that counts as on it: rounding of a double multiplier 1
FLIP_OR_FOLD = 1e-6  # [rad], angle of a multiplier that counts as real
KINDS = ("none", "fold", "flip", "Neimark-Sacker")

Array = NDArray[np.float64]


class Timing(NamedTuple):
    """When the controller samples and acts, and where its velocity comes from."""

    period: float  # T [s]
    delay: float  # [s], may exceed T
    derivative: str  # "measured" | "backward" | "filtered"
    filter_time: float  # [s], of the filtered one


class Loop(NamedTuple):
    """M = free + entry (P by_gain + D by_derivative)."""

    free: Array  # (n, n)
    entry: Array  # (n, 1)
    by_gain: Array  # (1, n)
    by_derivative: Array  # (1, n)
    period: float  # [s]


class Onset(NamedTuple):
    """How a loop loses stability."""

    gain: float  # where; inf if never
    kind: str  # of KINDS
    frequency: float  # [Hz], that it starts with


def sampled(plant: Plant, timing: Timing) -> Loop:
    """The loop of a plant. Raises ValueError for an unknown derivative."""
    n, wait, share = len(plant.a), *divmod(timing.delay / timing.period, 1.0)
    past = int(wait) + 1  # commands that have yet to act, the one in force included
    size = n + past + 2  # and the position and velocity remembered
    step, old, new = _held(plant, timing.period, share)
    free, entry = np.zeros((size, size)), np.zeros((size, 1))
    free[:n, :n], free[:n, n + past - 1] = step, old[:, 0]
    if past == 1:
        entry[:n] = new
    else:
        free[:n, n + past - 2] = new[:, 0]
    entry[n] = 1.0
    free[n + 1 : n + past, n : n + past - 1] = np.eye(past - 1)
    free[-2, :n] = plant.position[0]
    by_gain, by_derivative = np.zeros((1, size)), np.zeros((1, size))
    by_gain[0, :n] = -plant.position[0]
    by_derivative[0] = -_velocity(plant, timing, size)
    free[-1] = -by_derivative[0]
    return Loop(free, entry, by_gain, by_derivative, timing.period)


def _held(plant: Plant, period: float, share: float) -> tuple[Array, Array, Array]:
    """Of one period: the states by the states, by the command held for its first share, and by that for the rest."""
    from scipy.linalg import expm

    n = len(plant.a)
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n:] = plant.a, plant.b
    first, rest = (np.asarray(expm(whole * period * part), float) for part in (share, 1.0 - share))
    return rest[:n, :n] @ first[:n, :n], rest[:n, :n] @ first[:n, n:], rest[:n, n:]


def _velocity(plant: Plant, timing: Timing, size: int) -> Array:
    """The row of the velocity that the law takes; its memory is at the end: position, then velocity."""
    row, n = np.zeros(size), len(plant.a)
    if timing.derivative == "measured":
        row[:n] = plant.velocity[0]
        return row
    if timing.derivative not in ("backward", "filtered"):
        raise ValueError(f"derivative {timing.derivative!r} is none of 'measured', 'backward', 'filtered'")
    filtered = timing.derivative == "filtered" and timing.filter_time > 0.0
    kept = math.exp(-timing.period / timing.filter_time) if filtered else 0.0
    row[:n] = plant.position[0] * (1.0 - kept) / timing.period
    row[-2], row[-1] = -(1.0 - kept) / timing.period, kept
    return row


def multipliers(loop: Loop, gain: Array | float, derivative: Array | float) -> NDArray[np.complex128]:
    """Eigenvalues of M for gains of any one shape; a last axis is added."""
    p, d = np.broadcast_arrays(np.asarray(gain, float), np.asarray(derivative, float))
    rows = p[..., None, None] * loop.by_gain + d[..., None, None] * loop.by_derivative
    return np.linalg.eigvals(loop.free + loop.entry @ rows).astype(complex)


def excess(loop: Loop, gain: Array | float, derivative: Array | float) -> Array:
    """How far the largest multiplier lies outside the unit circle; above NEUTRAL the loop is unstable."""
    return np.abs(multipliers(loop, gain, derivative)).max(axis=-1) - 1.0


def stable(loop: Loop, gain: float, derivative: float) -> bool:
    """Do all swings die away?"""
    return bool(excess(loop, gain, derivative) <= NEUTRAL)


def outside(loop: Loop, gain: Array | float, derivative: Array | float) -> NDArray[np.int64]:
    """Number of multipliers outside the unit circle."""
    return (np.abs(multipliers(loop, gain, derivative)) > 1.0 + NEUTRAL).sum(axis=-1)


def onset(loop: Loop, gain: float, derivative: float) -> tuple[str, float]:
    """Kind and frequency [Hz] of the swing that grows fastest, or dies most slowly, at these gains."""
    found = multipliers(loop, gain, derivative)
    found = found[np.abs(found - 1.0) > 1e-6] if np.any(np.abs(found - 1.0) > 1e-6) else found
    angle = abs(float(np.angle(found[np.argmax(np.abs(found))])))
    kind = "flip" if math.pi - angle < FLIP_OR_FOLD else "fold" if angle < FLIP_OR_FOLD else "Neimark-Sacker"
    return kind, angle / (2.0 * math.pi * loop.period)
