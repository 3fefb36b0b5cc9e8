"""The sampled loop about the whole actuator, run: kink, root law, changing volumes and a valve that opens no wider.

Sample i is taken at i tau; its command u_i = -(s y1 + d v), cut to |u| <= limit, acts from (i + delay) tau until the
next one acts, as in `controller.stability.sampled`; v by the same three derivatives as in `controller.law`, 0 at the
first sample where it is a difference. Before the first command the valve is shut. Source: (5.7), (5.8), (5.23).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from controller.stability.actuator.constant_command import (
    LONGEST,
    STATE,
    Observed,
    SimulatedActuator,
    integrate,
)
from controller.stability.actuator.model import Actuator
from controller.stability.plant import Array
from controller.stability.timing import Timing
from twin.kernel import allocating_kernel, kernel

ALPHA = 0.0043  # of the thesis's digital charts, Figs 5.8 to 5.19
TOLERANCE = 1e-7  # of a step, in supply pressures; 1e-9 moves a swing by 1e-5 of itself and costs twice as much
WENT, END, LOST = 0, 1, 2  # how a run came out: to its end; the piston to that of the cylinder; its steps vanished
NEAR_END = 0.999  # chamber lengths: where steps vanish beyond it, the piston runs into the end with the valve open


class Sampled(NamedTuple):
    """A controller that samples."""

    s: float
    d: float
    tau: float
    delay: float  # sampling periods
    measured: bool  # velocity by a tachometer; else a difference
    kept: float  # of the last estimate, exp(-1/filter time); 0.0: the plain difference
    limit: float  # of |u|


class Tally(NamedTuple):
    """What the thirds of a run showed, arrays of three rows."""

    extremes: Array  # (3, 2) lowest and highest position
    passages: Array  # (3, 4) upward through the middle of the third before: how many, first, last; and that middle
    turns: Array  # (3, 3) of the samples: how many, how often they changed sides of it, how many met the valve's limit


class SampledRun(NamedTuple):
    """A run, sample by sample; rows that a run did not come to are NaN."""

    time: Array  # (n + 1,)
    states: Array  # (n + 1, 4) at the samples
    commands: Array  # (n,) given there
    outcome: int  # WENT | END | LOST


def controller(s: float, d: float, timing: Timing, limit: float = 1.0) -> Sampled:
    """A checked controller; one period, one delay. ValueError for a number out of range."""
    tau, delay = float(np.asarray(timing.tau)), float(np.asarray(timing.delay))
    named = {"s": s, "d": d, "delay": delay, "tau": tau, "limit": limit}
    for name, value in named.items():
        if not (math.isfinite(value) or name == "limit") or not value >= 0.0 or (name == "tau" and value == 0.0):
            raise ValueError(f"{name} {value} must be {'above' if name == 'tau' else 'at least'} 0, and finite")
    return Sampled(float(s), float(d), tau, delay, timing.derivative == "measured", timing.kept, float(limit))


def displaced(y1: float) -> Array:
    """The piston at rest at y1, half the supply in both chambers."""
    return np.array([y1, 0.0, 0.5, 0.5])


def simulate(
    start: ArrayLike,
    actuator: Actuator,
    loop: Sampled,
    periods: int,
    laminar: float = 0.0,
    tolerance: float = TOLERANCE,
) -> SampledRun:
    """Run a loop from a state (4,) for so many sampling periods."""
    states, commands = np.full((periods + 1, 4), np.nan), np.full(periods, np.nan)
    plant = SimulatedActuator(Actuator(*map(float, actuator)), float(laminar), float(tolerance))
    outcome = follow(np.array(start, float), plant, loop, periods, states, commands, tally())
    return SampledRun(loop.tau * np.arange(periods + 1.0), states, commands, outcome)


def tally() -> Tally:
    """An empty one."""
    return Tally(np.tile([np.inf, -np.inf], (3, 1)), np.zeros((3, 4)), np.zeros((3, 3)))


@kernel
def estimate(w, first, memory, loop: Sampled):
    """The velocity that the law takes; memory (position, estimate) at the last sample, renewed."""
    if loop.measured:
        return w[1]
    v = 0.0 if first else loop.kept * memory[1] + (1.0 - loop.kept) * (w[0] - memory[0]) / loop.tau
    memory[0], memory[1] = w[0], v
    return v


@allocating_kernel
def follow(start, plant: SimulatedActuator, loop: Sampled, periods, states, commands, seen: Tally):
    """Run a loop, keep the samples in `states` and `commands` if these have rows, count in `seen`; the outcome."""
    w, stages, trial, memory = start.copy(), np.empty((7, STATE)), np.empty(STATE), np.zeros(2)
    past = math.ceil(loop.delay)
    pending = np.zeros(past + 1)  # the command just given, then older ones
    share = loop.delay - max(past - 1, 0)  # of a period, in which the oldest still acts
    size, before = LONGEST, 0.0
    for i in range(periods):
        third = min(3 * i // periods, 2)
        if i > 0 and third > min(3 * (i - 1) // periods, 2):
            before = 0.0
            seen.passages[third, 3] = 0.5 * (seen.extremes[third - 1, 0] + seen.extremes[third - 1, 1])
        for age in range(past, 0, -1):
            pending[age] = pending[age - 1]
        h = loop.s * w[0] + loop.d * estimate(w, i == 0, memory, loop)
        pending[0] = max(min(-h, loop.limit), -loop.limit)
        seen.turns[third, 0] += 1.0
        side = w[0] - seen.passages[third, 3]
        seen.turns[third, 1] += side * before < 0.0
        seen.turns[third, 2] += abs(h) > loop.limit
        before = side if side != 0.0 else before
        if len(states):
            states[i], commands[i] = w, pending[0]
        of_third = Observed(seen.extremes[third], seen.passages[third])
        begin = i * loop.tau
        if share > 0.0:
            size = integrate(w, STATE, pending[past], begin, share * loop.tau, size, plant, stages, trial, of_third)
        if share < 1.0 and size > 0.0:
            younger = pending[max(past - 1, 0)]
            rest = (1.0 - share) * loop.tau
            size = integrate(w, STATE, younger, begin + share * loop.tau, rest, size, plant, stages, trial, of_third)
        if size == 0.0:
            return END if abs(w[0]) > NEAR_END else LOST
    if len(states):
        states[periods] = w
    return WENT
