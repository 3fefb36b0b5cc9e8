"""Simulated seconds per wall second of the circuit alone, one core."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from twin.block import compiled_for, flatten, run_block
from twin.equilibrium import equilibrium
from twin.rig import build, numbers

Row = tuple[str, str, str, str]
GOAL = 50.0


def speed(step: float, spool: float) -> float:
    """The better of three runs of 4 s, in blocks of 1 ms, the spool swinging when asked to."""
    circuit = build(numbers(), step)
    parameters, taps = compiled_for(circuit), np.zeros((2, 5))
    steps, best = round(1e-3 / step), 0.0
    for _ in range(3):
        state = flatten(equilibrium(circuit, 0.13))
        start = time.perf_counter()
        for k in range(4000):
            run_block(state, spool * (1.0 if k // 200 % 2 else -1.0), parameters, steps, taps)
        best = max(best, 4.0 / (time.perf_counter() - start))
    return best


def rows(folder: Path) -> Iterator[Row]:
    """Valve shut and swinging, at two steps."""
    for step in (50e-6, 100e-6):
        for words, spool in (("valve shut", 0.0), ("valve swinging fully", 1.0)):
            yield f"circuit, {step * 1e6:g} us, {words}", f"{speed(step, spool):.0f} x real time", "", ""
