"""Equal steps of a linear line as one matrix: what `march` does, many times faster once the matrix is there.

    x_(n+1) = R x_n + sum_i sum_k r_ik g_k(t_n + c_i h),    x = (y, w), g_k what the ends hold, c_i the stages' times

R and r are read off by taking single steps from unit states and unit values, so they are the scheme's own.
"""

from typing import NamedTuple

import numpy as np

from twin.lines.lab.integrate import PAIRS, runge_kutta
from twin.lines.lab.pipe import Array
from twin.lines.lab.system import LineSystem, State


class Propagator(NamedTuple):
    """One step of a scheme. m = 2 n + K n numbers of a state."""

    step: float  # h [s]
    matrix: Array  # R (m, m)
    drive: Array  # r (stages, held, m)
    stages: Array  # c (stages,)


def propagator(system: LineSystem, time: str, step: float) -> Propagator:
    """The step of backward Euler or an ESDIRK pair. ValueError: friction that is not linear, or bdf2."""
    if not system.model.linear or (time != "backward-euler" and time not in PAIRS):
        raise ValueError(f"friction {system.model.name} by {time} is not a single linear step; march it")
    stages = PAIRS[time].c if time in PAIRS else np.array([1.0])
    values, system.values = system.values, [lambda t: 0.0 for _ in system.values]
    size = 2 * system.nodes + len(system.alpha) * system.nodes
    matrix = np.array([_step(system, time, step, unit) for unit in np.eye(size)]).T
    drive = np.zeros((len(stages), len(values), size))
    for i, stage in enumerate(stages):
        for k in range(len(values)):
            system.values[k] = lambda t, stage=stage: float(abs(t - stage * step) < 1e-9 * step)
            drive[i, k] = _step(system, time, step, np.zeros(size))
            system.values[k] = lambda t: 0.0
    system.values = values
    return Propagator(step, matrix, drive, stages)


def _step(system: LineSystem, time: str, step: float, x: Array) -> Array:
    count = 2 * system.nodes
    state = State(x[:count], x[count:].reshape(len(system.alpha), system.nodes))
    frozen = system.freeze(state.y)
    if time in PAIRS:
        new = runge_kutta(system, PAIRS[time], state, 0.0, step, frozen)[0]
    else:
        new = system.solve(step, State(system.mass @ state.y, state.w), step, frozen)
    return np.concatenate([new.y, new.w.ravel()])


def propagate(system: LineSystem, one: Propagator, start: State, steps: int, held_over_step: bool = False) -> State:
    """The state after some steps from t = 0, whose ends start at what they hold."""
    shift = 0.0 * one.stages if held_over_step else one.stages
    times = one.step * np.add.outer(np.arange(steps), shift)
    held = np.array([[[value(t) for value in system.values] for t in row] for row in times])
    drive = np.tensordot(held, one.drive, axes=([1, 2], [0, 1]))
    x = np.concatenate([start.y, start.w.ravel()])
    for n in range(steps):
        x[system.rows] = [value(n * one.step) for value in system.values]
        x = one.matrix @ x + drive[n]
    count = 2 * system.nodes
    return State(x[:count], x[count:].reshape(start.w.shape))
