"""Time of one step of the relief valve alone, one core."""

import math
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.support.relief_valve import (
    BAR,
    FLOW,
    IMPEDANCE,
    PRESSURE,
    valve,
)
from twin.kernel import kernel
from twin.relief.steady import rest
from twin.relief.valve import (
    SHUT,
    Relief,
    ReliefState,
    relieve,
)

Row = tuple[str, str, str, str]
STEPS = 10_000


@kernel
def total_flow(s: ReliefState, flow: float, c: np.ndarray, valve: Relief, step: float) -> float:
    """Sum of Q over a run: nothing that the compiler could leave out."""
    total = 0.0
    for k in range(len(c) - 1):
        s, flow, _, _ = relieve(s, c[k], c[k + 1], IMPEDANCE, flow, valve, step)
        total += flow
    return total


def nanoseconds(s: ReliefState, flow: float, c: np.ndarray, step: float) -> float:
    """A step's time [ns], the best of 50 runs."""
    v, best = valve(), math.inf
    for _ in range(50):
        start = time.perf_counter()
        total_flow(s, flow, c, v, step)
        best = min(best, time.perf_counter() - start)
    return best / STEPS * 1e9


def rows(folder: Path) -> Iterator[Row]:
    """Shut, and at work with 3 % of ripple by the pump's teeth, at two steps."""
    for step, goal in ((50e-6, 120), (100e-6, 150)):
        ripple = np.sin(2.0 * math.pi * 184.5 * step * np.arange(STEPS + 1))
        shut = nanoseconds(SHUT, 0.0, 40 * BAR + 5 * BAR * ripple, step)
        work = nanoseconds(rest(PRESSURE, valve()), FLOW, PRESSURE + IMPEDANCE * FLOW * (1.0 + 0.03 * ripple), step)
        yield f"relief valve, {step * 1e6:g} us, shut", f"{shut:.1f} ns", "20 ns", ""
        yield f"relief valve, {step * 1e6:g} us, at work with ripple", f"{work:.0f} ns", f"{goal} ns", ""
