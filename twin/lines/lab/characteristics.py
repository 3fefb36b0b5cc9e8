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
def run(m, junction_of, held, values, fields, weight, memory, changes, out) -> None:
    """All steps.

    junction_of (lines, 2): junction at each end; held (junctions,): 1 pressure, 0 inflow; values (steps, junctions)
    [Pa] or [m^3/s] at each step's end; fields (2, 3, nodes): the start in the first; weight (nodes,); memory (K,
    nodes); changes (steps, nodes) for the convolution; out (steps + 1, lines, 4): p_1, p_2, u_1, u_2.
    """
    for line in range(len(m.numbers)):
        _weigh(m, line, fields[0], weight)
    for step in range(len(values)):
        now, new = fields[step & 1], fields[1 - (step & 1)]
        for line in range(len(m.numbers)):
            if m.numbers[line, PER_U] > 0.0:
                _weigh(m, line, now, weight)
            _know(m, line, step, now, memory, changes, new)
            _travel(m, line, now, weight, new)
        for junction in range(values.shape[1]):
            solve_junction(m, junction_of, junction, held[junction], values[step, junction], new)
        for line in range(len(m.numbers)):
            _remember(m, line, step, now, weight, new, memory, changes)
            low, high = m.first[line], m.first[line + 1] - 1
            out[step + 1, line, 0], out[step + 1, line, 1] = new[P, low], new[P, high]
            out[step + 1, line, 2], out[step + 1, line, 3] = new[U, low], new[U, high]


@kernel
def _weigh(m, line: int, now, weight) -> None:
    """1 + h/2 B at the nodes of a line; turbulence from the step's start."""
    n, half = m.numbers[line], 0.5 * m.step
    rest = n[MEMORY] * n[NEWEST] + n[SHEAR] / m.step
    for i in range(m.first[line], m.first[line + 1]):
        factor = turbulence(abs(now[U, i]) * n[PER_U]) if n[PER_U] > 0.0 else 1.0
        weight[i] = 1.0 + half * (n[BETA] * factor + rest)


@kernel
def _know(m, line: int, step: int, now, memory, changes, new) -> None:
    """K at the nodes of a line into the row of f: what is known of friction at the step's end beside B u."""
    n, low, high = m.numbers[line], m.first[line], m.first[line + 1]
    u, known = now[U], new[F]
    share = n[MEMORY] * n[NEWEST]
    for i in range(low, high):
        known[i] = -share * u[i]
    for j in range(m.decay.shape[1]):
        share, row = n[MEMORY] * m.decay[line, j], memory[j]
        for i in range(low, high):
            known[i] += share * row[i]
    for k in range(1, min(step + 1, m.kernel_weights.shape[1])):
        share, row = n[MEMORY] * m.kernel_weights[line, k], changes[step - k]
        for i in range(low, high):
            known[i] += share * row[i]
    if n[SHEAR] > 0.0:
        for i in range(low, high):
            back, ahead = max(i - 1, low), min(i + 1, high - 1)
            slope = abs(u[ahead] - u[back]) / (ahead - back) * n[PER_CELL]
            known[i] += n[SHEAR] * (-u[i] / m.step + np.sign(u[i]) * slope)


@kernel
def _travel(m, line: int, now, weight, new) -> None:
    """p and u at the step's end inside a line; at its ends c and Z in their place."""
    low, last, half = m.first[line], m.first[line + 1] - 1, 0.5 * m.step
    p, u, f, known, c = now[P], now[U], now[F], new[F], m.numbers[line, COURANT]
    p_new, u_new, per_flow = new[P], new[U], m.numbers[line, PER_FLOW]
    for i in range(low + 1, last):
        back = p[i - 1] + u[i - 1] - half * f[i - 1]
        ahead = p[i + 1] - u[i + 1] + half * f[i + 1]
        if c < 1.0:
            here = u[i] - half * f[i]
            back, ahead = (1.0 - c) * (p[i] + here) + c * back, (1.0 - c) * (p[i] - here) + c * ahead
        p_new[i] = 0.5 * (back + ahead)
        u_new[i] = (0.5 * (back - ahead) - half * known[i]) / weight[i]
    here, there = p[low] - u[low] + half * f[low], p[low + 1] - u[low + 1] + half * f[low + 1]
    p_new[low] = (1.0 - c) * here + c * there + half * known[low]
    here, there = p[last] + u[last] - half * f[last], p[last - 1] + u[last - 1] - half * f[last - 1]
    p_new[last] = (1.0 - c) * here + c * there - half * known[last]
    u_new[low], u_new[last] = weight[low] * per_flow, weight[last] * per_flow


@kernel
def _remember(m, line: int, step: int, now, weight, new, memory, changes) -> None:
    """Friction and memories of a line at the step's end."""
    low, high, per_half = m.first[line], m.first[line + 1], 2.0 / m.step
    before, u, f = now[U], new[U], new[F]
    for i in range(low, high):
        f[i] += per_half * (weight[i] - 1.0) * u[i]
    for j in range(m.decay.shape[1]):
        decay, gain, row = m.decay[line, j], m.gain[line, j], memory[j]
        for i in range(low, high):
            row[i] = decay * row[i] + gain * (u[i] - before[i])
    if m.kernel_weights.shape[1] > 0:
        for i in range(low, high):
            changes[step, i] = u[i] - before[i]


@kernel
def solve_junction(m, junction_of, junction: int, held: int, value: float, new) -> None:
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
