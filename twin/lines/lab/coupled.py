"""A line by the method of lines, solved together with other equations at its ends: a cylinder, a valve.

What is attached to an end has states z and a pressure p there, and gets the flow q out of the line:

    z' = f(t, z, p, q),      0 = g(t, z, p, q)

Held pressures enter a stage of the line linearly, so its velocities at the ends are a + B p there, B from one solution
per end; a stage of the whole is then a small system in (z, p), by Newton. Nothing lags: line and attachments are stages
of the same Runge-Kutta pair, with one step chosen by the error of both.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from twin.lines.lab.friction import Friction
from twin.lines.lab.integrate import GROWTH, LADDER, SAFETY
from twin.lines.lab.pipe import PRESSURE, Array, Case, End, Pipe, constant
from twin.lines.lab.space import Grid
from twin.lines.lab.system import Frozen, State, line_system
from twin.lines.lab.tableau import PAIRS

Law = Callable[[float, Array, float, float], Array]  # of t [s], z, p [Pa], q [m^3/s]
PASCAL = 1.0  # [Pa], size of an end's pressure in Newton's method
NEWTON, CLOSE = 30, 1e-4  # iterations, and the last change over the size of each unknown


class Attached(NamedTuple):
    """What sits at an end."""

    start: Array  # z at t = 0
    tolerated: Array  # of each z per step, as the line's tolerance is of its pressure
    rates: Law  # f
    balance: Callable[[float, Array, float, float], float]  # g [Pa]


class Whole(NamedTuple):
    """A line with what is attached to its ends, at a time."""

    line: State
    z: Array  # of both ends, in a row
    p: Array  # (2,) at the ends [Pa]
    q: Array  # (2,) out of the line [m^3/s]


class CoupledLine:
    """A pipe between two attachments."""

    def __init__(self, pipe: Pipe, grid: Grid, model: Friction, ends: Sequence[Attached], pressure: float) -> None:
        """At rest at a pressure [Pa], t = 0."""
        zero = End(PRESSURE, constant(0.0))
        self.system, start = line_system(Case(pipe, zero, zero, 0.0, pressure), grid, model)
        self.ends, self.pipe, n = ends, pipe, self.system.nodes
        self.rows, self.at = np.array([0, n - 1]), np.array([n, 2 * n - 1])
        self.out = pipe.area / pipe.hammer * np.array([-1.0, 1.0])  # of u at the ends
        counts = [len(end.start) for end in ends]
        self.parts = (slice(0, counts[0]), slice(counts[0], sum(counts)))
        self.start = Whole(start, np.concatenate([end.start for end in ends]), np.full(2, pressure), np.zeros(2))
        self.tolerated = np.concatenate([end.tolerated for end in ends])
        self._known: tuple[tuple[float, bytes], Array] = ((0.0, b""), np.zeros(0))  # of the last step

    def rates(self, t: float, z: Array, p: Array, q: Array) -> Array:
        """z' of both ends."""
        found = [
            end.rates(t, z[part], p[i], q[i]) for i, (end, part) in enumerate(zip(self.ends, self.parts, strict=True))
        ]
        return np.concatenate(found)

    def balances(self, t: float, z: Array, p: Array, q: Array) -> Array:
        """g of both ends [Pa]."""
        both = enumerate(zip(self.ends, self.parts, strict=True))
        return np.array([end.balance(t, z[part], p[i], q[i]) for i, (end, part) in both])

    def stage(self, theta: float, line: State, z: Array, t: float, frozen: Frozen, near: Whole) -> Whole:
        """The stage x = known + theta x'(x, t) of the whole; near: where Newton begins. ValueError: it finds none."""
        free = self.system.solve(theta, line, t, frozen)  # with 0 Pa held
        per_pressure = self._per_pressure(theta, frozen)
        response = self.out[:, None] * per_pressure[self.at]
        flow = self.out * free.y[self.at]

        def residual(x: Array) -> Array:
            p, q = x[len(z) :], flow + response @ x[len(z) :]
            off = (x[: len(z)] - theta * self.rates(t, x[: len(z)], p, q) - z) / self.tolerated
            return np.concatenate([off, self.balances(t, x[: len(z)], p, q) / PASCAL])

        sizes = np.concatenate([self.tolerated, np.full(2, PASCAL)])
        x = _newton(residual, np.concatenate([near.z, near.p]), sizes, t)
        p = x[len(z) :]
        y = free.y + per_pressure @ p
        return Whole(State(y, free.w + self._memory(theta, per_pressure @ p)), x[: len(z)], p, flow + response @ p)

    def _per_pressure(self, theta: float, frozen: Frozen) -> Array:
        """What 1 Pa held at an end adds to y, a column per end."""
        key = theta, frozen.beta.tobytes() + frozen.sigma.tobytes()
        if key == self._known[0]:
            return self._known[1]
        right = np.zeros((2 * self.system.nodes, 2))
        right[self.rows, [0, 1]] = theta
        solve = self.system.solver(theta, frozen)
        self._known = key, np.stack([solve(column) for column in right.T], axis=1)
        return self._known[1]

    def _memory(self, theta: float, y: Array) -> Array:
        """What a change of y adds to the memories of a stage."""
        gain = theta * self.system.alpha * self.system.model.weights / (1.0 + theta * self.system.alpha)
        return -gain[:, None] * y[self.system.nodes :]


def _newton(residual: Callable[[Array], Array], x: Array, sizes: Array, t: float) -> Array:
    """x at which a residual vanishes; its slopes by differences, anew where a change does not shrink to a tenth."""
    before, slope = 0.0, np.zeros(0)
    for _ in range(NEWTON):
        here = residual(x)
        if not slope.size:
            slope = np.linalg.inv(np.stack([residual(x + d) - here for d in np.diag(sizes)], axis=1))
        change = slope @ -here
        x, size = x + change * sizes, float(np.abs(change).max())
        if size < CLOSE:
            return x
        if 0.0 < before < 10.0 * size:
            slope = np.zeros(0)
        before = size
    raise ValueError(f"line and attachments find no common state at {t:.6g} s; take a smaller tolerance")


def march_coupled(
    line: CoupledLine, time: str, tolerance: float, span: float, most: int, longest: float = math.inf
) -> Iterator[tuple[float, Whole]]:
    """Steps as long as the error allows, from t = 0 to a span [s]: (t, whole). tolerance [Pa]: rms in the line.

    ValueError: more than `most` steps, tried ones counted.
    """
    now, t, step, tried = line.start, 0.0, min(span / 100.0, longest), 0
    yield t, now
    while t < span * (1.0 - 1e-12):
        tried += 1
        if tried > most:
            raise ValueError(f"{most} steps reach {t:.6g} of {span:.6g} s; take a larger tolerance than {tolerance} Pa")
        taken = min(step, span - t)
        new, size = _step(line, time, now, t, taken, tolerance)
        if size <= 1.0:
            t, now = t + taken, new
            yield t, now
        factor = SAFETY * max(size, 1e-12) ** (-1.0 / PAIRS[time].order)
        rungs = min(math.floor(math.log(factor, LADDER)), GROWTH)
        step = min(LADDER ** (round(math.log(step, LADDER)) + rungs), longest)


def _step(line: CoupledLine, time: str, now: Whole, t: float, step: float, tolerance: float) -> tuple[Whole, float]:
    """One step of a pair: the whole after it, and its error over what is tolerated."""
    pair, system = PAIRS[time], line.system
    theta, frozen, stages = step * pair.gamma, system.freeze(now.line.y), len(pair.c)
    first = system.rates(t, now.line, frozen)
    first.y[line.rows] = 0.0  # the ends' pressures have equations without derivative
    rates = [first.y, *[np.zeros_like(first.y)] * (stages - 1)]
    memories = [first.w, *[np.zeros_like(first.w)] * (stages - 1)]
    others = [line.rates(t, now.z, now.p, now.q), *[np.zeros_like(now.z)] * (stages - 1)]
    start, stage = system.mass @ now.line.y, now
    for i in range(1, stages):
        y, w, z = (
            known + step * sum(a * rate for a, rate in zip(pair.a[i, :i], past, strict=False))
            for known, past in ((start, rates), (now.line.w, memories), (now.z, others))
        )
        stage = line.stage(theta, State(y, w), z, t + pair.c[i] * step, frozen, stage)
        rates[i], memories[i] = (system.mass @ stage.line.y - y) / theta, (stage.line.w - w) / theta
        others[i] = (stage.z - z) / theta
    weights = step * (pair.b - pair.embedded)
    error = system.solver(theta, frozen)(weights @ np.array(rates))
    size = float(np.sqrt(np.mean(error**2))) / tolerance
    return stage, max(size, float(np.abs(weights @ np.array(others) / line.tolerated).max(initial=0.0)))
