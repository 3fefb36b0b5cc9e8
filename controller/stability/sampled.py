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
from controller.stability.plant import Array, Plant, linear_actuator, zero_order_hold
from controller.stability.timing import Timing

MOST_PAST = 100  # sampling periods of delay: the work grows with the cube


class SampledLoop(NamedTuple):
    """The loop from sample to sample, affine in both gains; n = plant + past inputs + memory."""

    free: Array  # M_0 (..., n, n), without control
    entry: Array  # b (..., n), where a new command enters
    position: Array  # p (n,)
    velocity: Array  # q (..., n), the estimate


def sampled_loop(plant: Plant, timing: Timing) -> SampledLoop:
    """The loop of a plant under a controller of this timing.

    Periods and delays broadcast with the plant's stack, as long as all delays round up to the same number of periods.
    Raises ValueError for tau <= 0, delay < 0, and for a derivative that is unknown or cannot be had.
    """
    tau, delay = np.asarray(timing.tau, float), np.asarray(timing.delay, float)
    past = _past_inputs(tau, delay)
    shape = np.broadcast_shapes(tau.shape, delay.shape, plant.b.shape[:-1])
    n, size = plant.b.shape[-1], plant.b.shape[-1] + past + _memory(plant, timing)
    free = np.zeros((*shape, size, size))
    entry, position = np.zeros(free.shape[:-1]), np.zeros(free.shape[-1])
    position[:n] = plant.position
    _carry(free, entry, plant, tau, delay, past)
    velocity = _estimate(free, n + past, plant, tau, timing)
    return SampledLoop(free, entry, position, velocity)


def _carry(free: Array, entry: Array, plant: Plant, tau: Array, delay: Array, past: int) -> None:
    """One period: the older input acts for a share f, the younger for the rest; then the inputs move on by one."""
    n, f = plant.b.shape[-1], delay - np.maximum(past - 1, 0)  # f = 1: a delay of whole periods
    older, rest = zero_order_hold(plant, f * tau), zero_order_hold(plant, (1.0 - f) * tau)
    if past == 0:
        free[..., :n, :n], entry[..., :n] = zero_order_hold(plant, tau)
        return
    free[..., :n, :n] = zero_order_hold(plant, tau)[0]
    free[..., :n, n + past - 1] = np.einsum("...ij,...j", rest[0], older[1])
    if past == 1:
        entry[..., :n] = rest[1]
    else:
        free[..., :n, n + past - 2] = rest[1]
    entry[..., n] = 1.0
    for age in range(1, past):
        free[..., n + age, n + age - 1] = 1.0


def _estimate(free: Array, at: int, plant: Plant, tau: Array, timing: Timing) -> Array:
    """The row of the velocity, and the memory it needs, from column `at` on: last position, last estimate."""
    n, row = plant.b.shape[-1], np.zeros(free.shape[:-1])
    if timing.derivative == "measured":
        row[..., :n] = plant.velocity
        return row
    a = timing.kept
    row[..., :n] = (1.0 - a) * plant.position / tau[..., None]
    row[..., at] = -(1.0 - a) / tau
    free[..., at, :n] = plant.position
    if timing.derivative == "filtered":
        row[..., at + 1] = a
        free[..., at + 1, :] = row
    return row


def closed(loop: SampledLoop, s: ArrayLike, d: ArrayLike) -> Array:
    """M_0 - b (s p + d q), (..., n, n); s and d broadcast with the loop's stack."""
    s, d = np.asarray(s, float)[..., None], np.asarray(d, float)[..., None]
    return loop.free - loop.entry[..., :, None] * (s * loop.position + d * loop.velocity)[..., None, :]


def with_system(loop: SampledLoop, a: Array, b: Array, c: Array, d: Array) -> SampledLoop:
    """The loop under a linear system in place of both gains; the gain s is a factor on its output then.

    z <- a z + b (y, v), u = s (c z + d (y, v)), of position and velocity: b is (m, 2), d (2,). The state grows by z.
    """
    n, m = loop.free.shape[-1], len(c)
    seen = np.stack(np.broadcast_arrays(loop.position, loop.velocity), axis=-2)
    free = np.zeros((*loop.free.shape[:-2], n + m, n + m))
    free[..., :n, :n], free[..., n:, :n], free[..., n:, n:] = loop.free, b @ seen, a
    row = np.zeros(free.shape[:-1])
    row[..., :n], row[..., n:] = -(d @ seen), -c
    entry = np.concatenate([loop.entry, np.zeros((*loop.entry.shape[:-1], m))], axis=-1)
    return SampledLoop(free, entry, row, np.zeros_like(row))


def monodromy(s: ArrayLike, d: ArrayLike, k: ArrayLike, gamma: ArrayLike, timing: Timing) -> Array:
    """The dimensionless actuator's matrix from sample to sample, (..., n, n); every number may be an array.

    n = 3 + ceil(delay) + (0, 1, 2 for measured, backward, filtered).
    Arrays broadcast; all delays of one call must round up to the same number. Raises ValueError as `sampled_loop`.
    """
    return closed(sampled_loop(linear_actuator(k, gamma), timing), s, d)


def critical_gain(d: ArrayLike, k: ArrayLike, gamma: ArrayLike, timing: Timing) -> float | Array:
    """Smallest s > 0 at which the loop loses stability; 0.0: unstable for all small s > 0; inf: never lost.

    A float for numbers, an array for arrays, which broadcast. Raises ValueError as `sampled_loop`.
    """
    cases = np.broadcast(*(np.asarray(value, float) for value in (d, k, gamma, timing.tau, timing.delay)))
    found = np.empty(cases.shape)
    for index, (d_, k_, gamma_, tau_, delay_) in zip(np.ndindex(cases.shape), cases, strict=True):
        loop = sampled_loop(linear_actuator(k_, gamma_), timing._replace(tau=tau_, delay=delay_))
        found[index] = first_loss(closed(loop, 0.0, d_), loop.entry, loop.position)
    return found if found.ndim else float(found)


def _past_inputs(tau: Array, delay: Array) -> int:
    if not (np.all(tau > 0.0) and np.all(np.isfinite(tau))):
        raise ValueError(f"sampling interval {tau} must be positive and finite; take the analogue loop for 0")
    if not (np.all(delay >= 0.0) and np.all(np.isfinite(delay))):
        raise ValueError(f"delay {delay} (sampling periods) must be 0 or more, and finite")
    past = np.unique(np.ceil(delay))
    if np.any(past > MOST_PAST):
        raise ValueError(f"a delay of {past.max():.0f} periods is beyond this theory, which ends at {MOST_PAST}")
    if len(past) > 1:
        raise ValueError(f"delays that round up to {past} periods give matrices of different size; take them in turn")
    return int(past[0])


def _memory(plant: Plant, timing: Timing) -> int:
    """Numbers that the derivative keeps. ValueError where it is wrong, or the plant has no tachometer for it."""
    if timing.derivative == "measured" and plant.velocity is None:
        raise ValueError("derivative 'measured', but the plant has no velocity output; take 'backward' or 'filtered'")
    return timing.memory
