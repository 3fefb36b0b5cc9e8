"""Marching a line system in time: backward Euler, BDF2, and pairs of ESDIRK with steps of their own choice.

Values of held ends are taken at the stages' own times. `held_over_step` takes them from the start of the step instead,
as the thesis did: every scheme is then of first order, which is all that it is there to show.
"""

import math
from collections.abc import Iterator
from itertools import islice

import numpy as np

from twin.lines.lab.pipe import Array
from twin.lines.lab.system import Frozen, LineSystem, State
from twin.lines.lab.tableau import PAIRS, Tableau

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
    return State(y, state.w)  # I_j and m_j u jump alike


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
    """One step: the state after it, its rates (the next step's first stage), and the error of M y [Pa]."""
    theta, stages, count = step * pair.gamma, len(pair.c), len(system.alpha) * system.nodes
    rates, memories = np.zeros((stages, 2 * system.nodes)), np.zeros((stages, count))
    known = first if first is not None and system.model.linear else system.rates(t, state, frozen)
    rates[0], memories[0] = known.y, known.w.ravel()
    start, stage = system.mass @ state.y, state
    for i in range(1, stages):
        row = step * pair.a[i, :i]
        w = state.w + (row @ memories[:i]).reshape(state.w.shape) if count else state.w
        z = State(start + row @ rates[:i], w)
        stage = system.solve(theta, z, t if held else t + pair.c[i] * step, frozen)
        rates[i] = (system.mass @ stage.y - z.y) / theta
        if count:
            memories[i] = ((stage.w - z.w) / theta).ravel()
    last = State(rates[-1].copy(), memories[-1].reshape(state.w.shape))
    off = step * (pair.b - pair.embedded) @ rates
    return stage, last, off


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
        filtered = system.solver(step * pair.gamma, frozen)(error)  # stiff parts would ask for needless steps
        size = float(np.sqrt(np.mean(filtered**2))) / tolerance
        if size <= 1.0:
            t, state, rates = t + step, new, after
            yield t, state
        elif step < LEAST * span:
            raise ValueError(f"tolerance {tolerance} Pa asks for steps under {step:.1e} s at {t:.6g} s; take a larger")
        factor = SAFETY * max(size, 1e-12) ** (-1.0 / pair.order)
        rung = min(rung + min(math.floor(math.log(factor, LADDER)), GROWTH), top)


def _rung(step: float) -> int:
    return math.floor(math.log(step, LADDER))
