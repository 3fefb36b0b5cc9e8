"""The method of characteristics: the mesh of any number of lines and its steps; `network.py` is the door.

    C+: d(p + u)/dt = -f,  C-: d(p - u)/dt = f;    f at a node is B u + K at the step's end, K from the past

so with the trapezoidal rule along each characteristic, feet L and R where it started,

    p + (1 + h/2 B) u = p_L + u_L - h/2 f_L - h/2 K,      p - (1 + h/2 B) u = p_R - u_R + h/2 f_R + h/2 K

At Courant number 1 the feet are nodes and a frictionless line is exact; below it they are interpolated in straight
lines, which damps: fig. 2.23. (2.68), (2.69) lack rho a before S. A junction: p = (Q + sum c_i/Z_i)/sum 1/Z_i, its
lines' ends as p = c + Z q, q into the line, (2.101); a pipe alone lies between two junctions of one end each.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.kernel import kernel
from twin.lines.friction import turbulence
from twin.lines.lab.friction import Friction, convolution_weights, recursion
from twin.lines.lab.pipe import Array, Pipe

# numbers of a line
COURANT, BETA, MEMORY, SHEAR, PER_U, PER_CELL, NEWEST, PER_FLOW = range(8)
P, U, F = range(3)  # rows of a field: pressure, rho a v, friction


class Mesh(NamedTuple):
    """Lines side by side on one step, their nodes in a row."""

    step: float  # h [s]
    first: NDArray[np.int64]  # (lines + 1,) first node of each
    numbers: Array  # (lines, 8)
    decay: Array  # (lines, K) of the memories
    gain: Array  # (lines, K)
    kernel_weights: Array  # (lines, steps) of the whole convolution; (lines, 0) without


def mesh(pipes: Sequence[Pipe], models: Sequence[Friction], step: float, cells: Sequence[int], steps: int) -> Mesh:
    """A mesh; the Courant number a h/dx of each line is at most 1, else ValueError."""
    numbers = np.zeros((len(pipes), 8))
    memories = [recursion(m, pipe.viscous_time, step) for pipe, m in zip(pipes, models, strict=True)]
    count = max(len(decay) for decay, _ in memories)
    decay, gain = np.zeros((len(pipes), count)), np.zeros((len(pipes), count))
    history = np.zeros((len(pipes), steps if any(m.convolved for m in models) else 0))
    for i, (pipe, model, n) in enumerate(zip(pipes, models, cells, strict=True)):
        courant = pipe.speed * step * n / pipe.length
        if not courant <= 1.0 + 1e-9:
            raise ValueError(f"Courant number {courant:.3f} above 1; take {int(n / courant)} cells or a smaller step")
        decay[i, : len(memories[i][0])], gain[i, : len(memories[i][0])] = memories[i]
        if model.convolved:
            history[i] = convolution_weights(pipe.viscous_time, step, steps)
        numbers[i, COURANT] = 1.0 if abs(courant - 1.0) < 1e-9 else courant
        numbers[i, BETA] = model.steady * pipe.steady_rate
        numbers[i, MEMORY] = 4.0 / pipe.viscous_time
        numbers[i, SHEAR] = 0.5 * model.brunone
        numbers[i, PER_U] = pipe.diameter / (pipe.viscosity * pipe.hammer) if model.turbulent else 0.0
        numbers[i, PER_CELL] = pipe.speed * n / pipe.length
        numbers[i, NEWEST] = gain[i].sum() + (history[i, 0] if model.convolved else 0.0)
        numbers[i, PER_FLOW] = pipe.hammer / pipe.area
    return Mesh(step, np.cumsum([0, *(n + 1 for n in cells)]), numbers, decay, gain, history)


@kernel
def _past(m, line: int, i: int, step: int, now, memory, changes) -> float:
    """K at a node: what is known of friction at the step's end beside B u."""
    n, u = m.numbers[line], now[U, i]
    total = 0.0
    for j in range(m.decay.shape[1]):
        total += m.decay[line, j] * memory[j, i]
    for k in range(1, min(step + 1, m.kernel_weights.shape[1])):
        total += m.kernel_weights[line, k] * changes[step - k, i]
    known = n[MEMORY] * (total - n[NEWEST] * u)
    if n[SHEAR] > 0.0:
        low, high = max(i - 1, m.first[line]), min(i + 1, m.first[line + 1] - 1)
        slope = abs(now[U, high] - now[U, low]) / (high - low) * n[PER_CELL]
        known += n[SHEAR] * (-u / m.step + np.sign(u) * slope)
    return known


@kernel
def _present(m, line: int, u: float) -> float:
    """B at a node."""
    n = m.numbers[line]
    factor = turbulence(abs(u) * n[PER_U]) if n[PER_U] > 0.0 else 1.0
    return n[BETA] * factor + n[MEMORY] * n[NEWEST] + n[SHEAR] / m.step


@kernel
def run(m, junction_of, held, values, now, new, memory, changes, out) -> None:
    """All steps.

    junction_of (lines, 2): junction at each end; held (junctions,): 1 pressure, 0 inflow; values (steps, junctions)
    [Pa] or [m^3/s] at each step's end; now, new (3, nodes); memory (K, nodes); changes (steps, nodes) for the
    convolution; out (steps + 1, lines, 4): p_1, p_2, u_1, u_2.
    """
    lines, half = len(m.numbers), 0.5 * m.step
    for step in range(len(values)):
        for line in range(lines):
            low, high, c = m.first[line], m.first[line + 1] - 1, m.numbers[line, COURANT]
            for i in range(low, high + 1):
                present, known = _present(m, line, now[U, i]), _past(m, line, i, step, now, memory, changes)
                back, ahead = max(i - 1, low), min(i + 1, high)
                right = _foot(now, i, back, c, 1.0, half) - half * known
                left = _foot(now, i, ahead, c, -1.0, half) + half * known
                weight = 1.0 + half * present
                new[P, i], new[U, i] = 0.5 * (right + left), 0.5 * (right - left) / weight
                if i == low:
                    new[P, i], new[U, i] = left, weight * m.numbers[line, PER_FLOW]  # c and Z of the end
                elif i == high:
                    new[P, i], new[U, i] = right, weight * m.numbers[line, PER_FLOW]
                new[F, i] = known
        for junction in range(values.shape[1]):
            meet(m, junction_of, junction, held[junction], values[step, junction], new)
        for line in range(lines):
            for i in range(m.first[line], m.first[line + 1]):
                change = new[U, i] - now[U, i]
                new[F, i] += _present(m, line, now[U, i]) * new[U, i]
                for j in range(m.decay.shape[1]):
                    memory[j, i] = m.decay[line, j] * memory[j, i] + m.gain[line, j] * change
                if m.kernel_weights.shape[1] > 0:
                    changes[step, i] = change
                for row in range(3):
                    now[row, i] = new[row, i]
            low, high = m.first[line], m.first[line + 1] - 1
            out[step + 1, line, 0], out[step + 1, line, 1] = now[P, low], now[P, high]
            out[step + 1, line, 2], out[step + 1, line, 3] = now[U, low], now[U, high]


@kernel
def _foot(now, i: int, beside: int, courant: float, sign: float, half: float) -> float:
    """p +- (u - h/2 f) where a characteristic started."""
    here = now[P, i] + sign * (now[U, i] - half * now[F, i])
    there = now[P, beside] + sign * (now[U, beside] - half * now[F, beside])
    return here + courant * (there - here)


@kernel
def meet(m, junction_of, junction: int, held: int, value: float, new) -> None:
    """Solve a junction; its ends hold c and Z in the rows of p and u, and get p and u."""
    pressure, total = value, 0.0
    if held == 0:
        pressure = value
        for line in range(len(m.numbers)):
            for end in range(2):
                if junction_of[line, end] == junction:
                    i = m.first[line] if end == 0 else m.first[line + 1] - 1
                    pressure += new[P, i] / new[U, i]
                    total += 1.0 / new[U, i]
        pressure /= total
    for line in range(len(m.numbers)):
        for end in range(2):
            if junction_of[line, end] == junction:
                i = m.first[line] if end == 0 else m.first[line + 1] - 1
                flow = (pressure - new[P, i]) / new[U, i]
                new[P, i], new[U, i] = pressure, flow * m.numbers[line, PER_FLOW] * (1.0 - 2.0 * end)
