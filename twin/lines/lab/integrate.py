"""Marching a line system in time: backward Euler, BDF2, and pairs of ESDIRK with steps of their own choice.

Values of held ends are taken at the stages' own times. `held_over_step` takes them from the start of the step instead,
as the source did: every scheme is then of first order, which is all that it is there to show.
"""

import math
from collections.abc import Iterator
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.lines.lab.system import Frozen, LineSystem, State
from twin.lines.lab.tableau import PAIRS, Tableau

Array = NDArray[np.float64]
TIMES = ("backward-euler", "bdf2", *PAIRS)
SAFETY = 0.9
LADDER = 2.0**0.25  # steps are powers of it: few factorisations
GROWTH = 4  # rungs up at most
LEAST = 1e-9  # of the span, shortest step


def march(
    system: LineSystem, start: State, time: str, step: float, held_over_step: bool = False
) -> Iterator[tuple[float, State]]:
    """Equal steps [s] for ever: (t, state) from t = 0 on, the start with the held values of t = 0."""
    if time not in TIMES:
        raise ValueError(f"time {time!r} unknown; known: {', '.join(TIMES)}")
    state, before = _held(system, start, 0.0), None
    yield 0.0, state
    rates: State | None = None
    k = 0
    while True:
        t, at = k * step, (k + 1) * step
        if held_over_step:
            state, rates, at = _held(system, state, t), None, t
        frozen = system.freeze(state.y)
        if time in PAIRS:
            new, rates, _ = runge_kutta(system, PAIRS[time], state, t, step, frozen, rates, held_over_step)
        elif time == "bdf2" and before is not None:
            z = State(system.mass @ (4.0 * state.y - before.y) / 3.0, (4.0 * state.w - before.w) / 3.0)
            new = system.solve(2.0 / 3.0 * step, z, at, frozen)
        else:
            new = system.solve(step, State(system.mass @ state.y, state.w), at, frozen)
        before, state, k = state, new, k + 1
        yield k * step, state


def until(system: LineSystem, start: State, time: str, step: float, end: float, held_over_step: bool = False) -> State:
    """The state after end/step equal steps."""
    steps = round(end / step)
    return next(islice(march(system, start, time, step, held_over_step), steps, None))[1]


def _held(system: LineSystem, state: State, t: float) -> State:
    """The state with the ends at their values."""
    y = state.y.copy()
    y[system.rows] = system.source(t)[system.rows]
    w = state.w - system.model.weights[:, None] * (y - state.y)[system.nodes :]  # I goes on without a jump of u
    return State(y, w + system.model.weights[:, None] * (y - state.y)[system.nodes :])


def runge_kutta(
    system: LineSystem,
    pair: Tableau,
    state: State,
    t: float,
    step: float,
    frozen: Frozen,
    first: State | None = None,
    held: bool = False,
) -> tuple[State, State, Array]:
    """One step: the state after it, its rates (the next step's first stage) and the error of y [Pa], filtered."""
    theta = step * pair.gamma
    rates = [first if first is not None and system.model.linear else system.rates(t, state, frozen)]
    start = system.mass @ state.y
    stage = state
    for i in range(1, len(pair.c)):
        z = State(_sum(start, step, pair.a[i], [r.y for r in rates]), _sum(state.w, step, pair.a[i], [r.w for r in rates]))
        stage = system.solve(theta, z, t if held else t + pair.c[i] * step, frozen)
        rates.append(State((system.mass @ stage.y - z.y) / theta, (stage.w - z.w) / theta))
    off = _sum(np.zeros_like(start), step, pair.b - pair.embedded, [r.y for r in rates])
    return stage, rates[-1], system.solver(theta, frozen).solve(off)


def _sum(start: Array, step: float, row: Array, terms: list[Array]) -> Array:
    out = start
    for factor, term in zip(row, terms, strict=False):
        if factor:
            out = out + (step * factor) * term
    return out


def march_adaptive(
    system: LineSystem, start: State, time: str, tolerance: float, span: float, longest: float = math.inf
) -> Iterator[tuple[float, State]]:
    """Steps as long as the rms of the embedded error stays below a tolerance [Pa]; ends exactly at the span [s]."""
    if time not in PAIRS:
        raise ValueError(f"time {time!r} has no embedded error; take a step, or one of {', '.join(PAIRS)}")
    pair, t, rates = PAIRS[time], 0.0, None
    state = _held(system, start, 0.0)
    rung, top = _rung(min(span / 100.0, longest)), _rung(min(span, longest))
    yield t, state
    while t < span * (1.0 - 1e-12):
        step = min(LADDER**rung, span - t)
        frozen = system.freeze(state.y)
        new, after, error = runge_kutta(system, pair, state, t, step, frozen, rates)
        size = float(np.sqrt(np.mean(error**2))) / tolerance
        if size <= 1.0:
            t, state, rates = t + step, new, after
            yield t, state
        elif step < LEAST * span:
            raise ValueError(f"tolerance {tolerance} Pa asks for steps under {step:.1e} s at {t:.6g} s; take a larger")
        factor = SAFETY * max(size, 1e-12) ** (-1.0 / pair.order)
        rung = min(rung + min(math.floor(math.log(factor, LADDER)), GROWTH), top)


def _rung(step: float) -> int:
    return math.floor(math.log(step, LADDER))


def transition(system: LineSystem, time: str, step: float) -> Array:
    """The matrix of one step of a linear system with ends at zero, over all of (y, w); y-columns of held rows are 0."""
    rest: Any = np.zeros(2 * system.nodes)
    frozen = system.freeze(rest)
    count, memories = 2 * system.nodes, len(system.alpha)
    out = np.zeros((count + memories * system.nodes,) * 2)
    for column in range(len(out)):
        unit = np.zeros(len(out))
        unit[column] = 1.0
        unit[system.rows] = 0.0
        state = State(unit[:count], unit[count:].reshape(memories, system.nodes))
        if time in PAIRS:
            new = runge_kutta(system, PAIRS[time], state, 0.0, step, frozen)[0]
        else:
            new = system.solve(step, State(system.mass @ state.y, state.w), 0.0, frozen)
        out[:, column] = np.concatenate([new.y, new.w.ravel()])
    return out
