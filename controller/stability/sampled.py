"""The sampled loop: a linear plant, samples at whole periods, a delay, a hold, and the derivative of the controller.

u_i = -(s y_i + d v_i) from the sample at t_i acts from t_i + delay until the next one acts, and

    X_{i+1} = (M_0 - b (s p + d q)) X_i,   X = (x, u_{i-1}, u_{i-2}, ..., memory of the derivative),

where p reads the position and q the velocity that the law uses. It is the law of `controller.law`, term by term:
`measured` is the tachometer at the sample, `backward` v_i = (y_i - y_{i-1})/tau, `filtered`
v_i = a v_{i-1} + (1 - a)(y_i - y_{i-1})/tau with a = exp(-1/filter_time). An offset of the samples moves the instants
and nothing else: the plant does not know the time. Source: (5.27) to (5.33), there without delay and for `measured`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from controller.stability.crossing import first_loss
from controller.stability.plant import Array, Plant, held, linear_actuator

DERIVATIVES = ("measured", "backward", "filtered")


class SampledLoop(NamedTuple):
    """The loop from sample to sample, affine in both gains; n = plant + past inputs + memory."""

    free: Array  # M_0 (..., n, n), without control
    entry: Array  # b (..., n), where a new command enters
    position: Array  # p (n,)
    velocity: Array  # q (..., n), the estimate


def sampled_loop(
    plant: Plant,
    tau: ArrayLike,
    delay: ArrayLike = 0.0,
    derivative: str = "measured",
    filter_time: float | None = None,
) -> SampledLoop:
    """The loop of a plant sampled at tau, in the plant's unit of time; delay and filter time in sampling periods.

    tau and delay broadcast with the plant's stack, as long as all delays round up to the same number of periods.
    Raises ValueError for tau <= 0, delay < 0, and for a derivative that is unknown or cannot be had.
    """
    tau, delay = np.asarray(tau, float), np.asarray(delay, float)
    past = _past_inputs(tau, delay)
    shape = np.broadcast_shapes(tau.shape, delay.shape, plant.b.shape[:-1])
    memory = {"measured": 0, "backward": 1, "filtered": 2}[_checked(plant, derivative, filter_time)]
    n = plant.b.shape[-1]
    free = np.zeros((*shape, n + past + memory, n + past + memory))
    entry, position = np.zeros(free.shape[:-1]), np.zeros(free.shape[-1])
    position[:n] = plant.position
    _carry(free, entry, plant, tau, delay, past)
    velocity = _estimate(free, n + past, plant, tau, derivative, filter_time or 0.0)
    return SampledLoop(free, entry, position, velocity)


def _carry(free: Array, entry: Array, plant: Plant, tau: Array, delay: Array, past: int) -> None:
    """One period: the older input acts for a share f, the younger for the rest; then the inputs move on by one."""
    n, f = plant.b.shape[-1], delay - np.maximum(past - 1, 0)  # f = 1: a delay of whole periods
    older, rest = held(plant, f * tau), held(plant, (1.0 - f) * tau)
    if past == 0:
        free[..., :n, :n], entry[..., :n] = held(plant, tau)
        return
    free[..., :n, :n] = held(plant, tau)[0]
    free[..., :n, n + past - 1] = np.einsum("...ij,...j", rest[0], older[1])
    if past == 1:
        entry[..., :n] = rest[1]
    else:
        free[..., :n, n + past - 2] = rest[1]
    entry[..., n] = 1.0
    for age in range(1, past):
        free[..., n + age, n + age - 1] = 1.0


def _estimate(free: Array, at: int, plant: Plant, tau: Array, derivative: str, filter_time: float) -> Array:
    """The row of the velocity, and the memory it needs, from column `at` on: last position, last estimate."""
    n, row = plant.b.shape[-1], np.zeros(free.shape[:-1])
    if derivative == "measured":
        row[..., :n] = plant.velocity
        return row
    a = np.exp(-1.0 / filter_time) if derivative == "filtered" and filter_time > 0.0 else 0.0
    row[..., :n] = (1.0 - a) * plant.position / tau[..., None]
    row[..., at] = -(1.0 - a) / tau
    free[..., at, :n] = plant.position
    if derivative == "filtered":
        row[..., at + 1] = a
        free[..., at + 1, :] = row
    return row


def closed(loop: SampledLoop, s: ArrayLike, d: ArrayLike) -> Array:
    """M_0 - b (s p + d q), (..., n, n); s and d broadcast with the loop's stack."""
    s, d = np.asarray(s, float)[..., None], np.asarray(d, float)[..., None]
    return loop.free - loop.entry[..., :, None] * (s * loop.position + d * loop.velocity)[..., None, :]


def monodromy(
    s: ArrayLike,
    d: ArrayLike,
    k: ArrayLike,
    gamma: ArrayLike,
    tau: ArrayLike,
    delay: ArrayLike = 0.0,
    derivative: str = "measured",
    filter_time: float | None = None,
) -> Array:
    """The dimensionless actuator's matrix from sample to sample, (..., n, n); every number may be an array.

    n = 3 + ceil(delay) + (0, 1, 2 for measured, backward, filtered); delay and filter time in sampling periods.
    Arrays broadcast; all delays of one call must round up to the same number. Raises ValueError as `sampled_loop`.
    """
    return closed(sampled_loop(linear_actuator(k, gamma), tau, delay, derivative, filter_time), s, d)


def critical_gain(
    d: ArrayLike,
    k: ArrayLike,
    gamma: ArrayLike,
    tau: ArrayLike,
    delay: ArrayLike = 0.0,
    derivative: str = "measured",
    filter_time: float | None = None,
) -> float | Array:
    """Smallest s > 0 at which the loop loses stability; 0.0: unstable for all small s > 0; inf: never lost.

    A float for numbers, an array for arrays, which broadcast. Raises ValueError as `sampled_loop`.
    """
    cases = np.broadcast(*(np.asarray(value, float) for value in (d, k, gamma, tau, delay)))
    found = np.empty(cases.shape)
    for index, (d_, k_, gamma_, tau_, delay_) in zip(np.ndindex(cases.shape), cases, strict=True):
        loop = sampled_loop(linear_actuator(k_, gamma_), tau_, delay_, derivative, filter_time)
        found[index] = first_loss(closed(loop, 0.0, d_), loop.entry, loop.position)
    return found if found.ndim else float(found)


def _past_inputs(tau: Array, delay: Array) -> int:
    if not (np.all(tau > 0.0) and np.all(np.isfinite(tau))):
        raise ValueError(f"sampling interval {tau} must be positive and finite; take the analogue loop for 0")
    if not (np.all(delay >= 0.0) and np.all(np.isfinite(delay))):
        raise ValueError(f"delay {delay} (sampling periods) must be 0 or more, and finite")
    past = np.unique(np.ceil(delay))
    if len(past) > 1:
        raise ValueError(f"delays that round up to {past} periods give matrices of different size; take them in turn")
    return int(past[0])


def _checked(plant: Plant, derivative: str, filter_time: float | None) -> str:
    if derivative not in DERIVATIVES:
        raise ValueError(f"derivative {derivative!r} is none of {', '.join(map(repr, DERIVATIVES))}")
    if derivative == "measured" and plant.velocity is None:
        raise ValueError("derivative 'measured', but the plant has no velocity output; take 'backward' or 'filtered'")
    if derivative == "filtered" and not (filter_time is not None and 0.0 <= filter_time < np.inf):
        raise ValueError(f"derivative 'filtered' needs a filter time of 0 or more sampling periods, not {filter_time}")
    return derivative
