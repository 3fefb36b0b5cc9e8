"""Lines that meet at junctions, by characteristics: what is held where, the start, and one pipe alone."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from twin.lines.friction import turbulence
from twin.lines.lab.characteristics import BETA, PER_FLOW, PER_U, F, Mesh, P, U, mesh, run, solve_junction
from twin.lines.lab.friction import Friction
from twin.lines.lab.pipe import PRESSURE, Array, Case, History, Pipe, sampled, steady_pressure


class Net(NamedTuple):
    """Lines and where they meet."""

    pipes: tuple[Pipe, ...]
    junction_of: tuple[tuple[int, int], ...]  # per line: junction at end 1, at end 2
    held: tuple[int, ...]  # per junction: 1 if its pressure is given, 0 if its inflow is


def march_net(
    net: Net,
    models: Sequence[Friction],
    step: float,
    cells: Sequence[int],
    values: Array,
    pressure: Sequence[Array],
    velocity: Sequence[float],
) -> Array:
    """Run lines that meet. values (steps + 1, junctions): pressure [Pa] or inflow [m^3/s] from t = 0 on; pressure: at
    each line's nodes, and velocity [m/s] of each line before. Returns (steps + 1, lines, 4): p_1, p_2 [Pa], v_1, v_2
    [m/s]."""  # fmt: skip
    steps = len(values) - 1
    m = mesh(net.pipes, models, step, cells, steps)
    nodes = int(m.first[-1])
    fields = np.zeros((2, 3, nodes))
    now = fields[0]
    now[P] = np.concatenate(list(pressure))
    for i, (pipe, v) in enumerate(zip(net.pipes, velocity, strict=True)):
        at = slice(m.first[i], m.first[i + 1])
        now[U, at] = pipe.hammer * v
        now[F, at] = [(_present_steady(m, i, u)) * u for u in now[U, at]]
    memory = np.zeros((m.decay.shape[1], nodes))
    changes = np.zeros((steps if m.kernel_weights.shape[1] else 0, nodes))
    out = np.zeros((steps + 1, len(net.pipes), 4))
    junction_of, held = np.array(net.junction_of), np.array(net.held)
    _jump(m, junction_of, held, values[0], now, out)
    run(m, junction_of, held, values[1:], fields, np.zeros(nodes), memory, changes, out)
    out[:, :, 2:] /= np.array([pipe.hammer for pipe in net.pipes])[:, None]
    return out


def _present_steady(m: Mesh, line: int, u: float) -> float:
    n = m.numbers[line]
    return n[BETA] * (turbulence(abs(u) * n[PER_U]) if n[PER_U] > 0.0 else 1.0)


def _jump(m: Mesh, junction_of: Any, held: Any, values: Array, now: Array, out: Array) -> None:
    """The ends at t = 0: whatever jumps there sends p -+ u of the steady flow into the line."""
    ends = now.copy()
    for line, row in enumerate(m.numbers):
        low, high = m.first[line], m.first[line + 1] - 1
        ends[P, low], ends[P, high] = now[P, low] - now[U, low], now[P, high] + now[U, high]
        ends[U, [low, high]] = row[PER_FLOW]
    for junction, kind in enumerate(held):
        solve_junction(m, junction_of, junction, int(kind), float(values[junction]), ends)
    for line in range(len(m.numbers)):
        both = [m.first[line], m.first[line + 1] - 1]
        now[:2, both] = ends[:2, both]
        out[0, line] = *now[P, both], *now[U, both]


def characteristics(case: Case, model: Friction, cells: int, span: float, courant: float = 1.0) -> History:
    """One pipe. ValueError: Courant number outside (0, 1]."""
    if not 0.0 < courant <= 1.0:
        raise ValueError(f"Courant number {courant} is outside 0 < C <= 1, where characteristics are stable")
    pipe = case.pipe
    step = courant * pipe.travel_time / cells
    times = step * np.arange(round(span / step) + 1)
    values = np.zeros((len(times), 2))
    for k, end in enumerate((case.left, case.right)):
        factor = 1.0 if end.holds == PRESSURE else (1.0 - 2.0 * k) * pipe.area
        values[:, k] = factor * sampled(end, times)
    net = Net((pipe,), ((0, 1),), (int(case.left.holds == PRESSURE), int(case.right.holds == PRESSURE)))
    per_u = pipe.diameter / (pipe.viscosity * pipe.hammer) if model.turbulent else 0.0
    rate = model.steady * pipe.steady_rate * turbulence(abs(pipe.hammer * case.velocity) * per_u)
    start = steady_pressure(case, np.linspace(0.0, pipe.length, cells + 1), rate)
    found = march_net(net, [model], step, [cells], values, [start], [case.velocity])[:, 0]
    return History(times, *found.T)
