"""The built-in drives beside the thesis's rig, in turns: simulated seconds per wall second at a step of 100 us.

The valve is thrown between wide open and shut, so that what is fitted works.
"""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bridge.scenario import load
from bridge.scenario.circuit import circuit_of, rest_of
from tests.benchmarks.plant import Row
from tests.support.warm import DRIVES
from twin.circuit.block import block_of, buffers, compiled

STEP = "loop.step=100e-6"
RIG = "step"
STEPS = 10  # of a block, 1 ms
SPOOLS = np.repeat([0.4, -0.4, 0.0, 0.15, -0.15], 200)  # one block each
TURNS = 15
GOAL = 0.5


class Timed:
    """A drive and the best time of a turn."""

    def __init__(self, name: str) -> None:
        scenario = load(name, [STEP])
        self.run, self.rest, self.buffers = block_of(compiled(circuit_of(scenario))), rest_of(scenario), buffers()
        self.best = float("inf")

    def turn(self) -> None:
        """A second from rest."""
        state = self.rest.copy()
        begin = time.perf_counter()
        for spool in SPOOLS:
            self.run(state, spool, STEPS, *self.buffers)
        self.best = min(self.best, time.perf_counter() - begin)


def rows(_: Path) -> Iterator[Row]:
    """Times real time, and the ratio to the thesis's rig."""
    timed = {name: Timed(name) for name in (RIG, *DRIVES)}
    for _turn in range(TURNS):
        for drive in timed.values():
            drive.turn()
    whole = len(SPOOLS) * 1e-3
    for name, drive in timed.items():
        ratio = timed[RIG].best / drive.best
        yield f"drive {name}, 100 us", f"{whole / drive.best:.0f} x real time, {ratio:.2f} of {RIG}", f"{GOAL:g}", ""
