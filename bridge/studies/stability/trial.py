"""One run of the twin under its sampled controller, without messages: what sweeps are made of.

The same hold, card and control law as in `bridge.loop.plant` and `bridge.loop.controller`, so the piston moves as in
any other mode, bit for bit; but the plant is asked for no more than the sampling instants and a few between them.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.loop.acquisition import Acquisition
from bridge.loop.controller import READ, ControllerSide
from bridge.loop.further import further_channels
from bridge.loop.refuge import CENTRED
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of, rest_of
from bridge.studies.stability.sampled_law import scaled
from controller.grid import NS, Sampling, is_sample
from controller.hold import Hold
from controller.law import NO_CHANNELS, Sample
from controller.reference import evaluate
from twin.circuit.block import Compiled, block_of, compiled
from twin.sensors import put_out
from twin.topology import CHANNELS, OBSERVED

ROWS = 8  # of a trace to a sampling interval, or fewer: every call of the plant costs as much as some steps
DENSEST = 5_000_000  # [ns], between rows of a trace, unless samples are closer

READ_AT = [[*CHANNELS].index(name) for name in READ]  # what a law is given of a scan
OURS = ("pd", "pid", "relay", "open-loop")  # laws that need no care
WATCHED = [list(OBSERVED).index(name) for name in ("position", "spool")]  # of a trace, beside its time

Array = NDArray[np.float64]


class Stand(NamedTuple):
    """A rig, compiled, at rest: made once for many runs."""

    circuit: Compiled
    rest: Array  # flat state


class Trace(NamedTuple):
    """What a run is judged by, all of one length."""

    time: Array  # [s]
    position: Array  # [m]
    spool: Array  # -1..1


def stand(scenario: Scenario) -> Stand:
    """The scenario's rig at its start. Raises ScenarioError where it has none."""
    return Stand(compiled(circuit_of(scenario)), rest_of(scenario))


def trial(scenario: Scenario, on: Stand, factor: float = 1.0) -> Trace:
    """Run a scenario on a stand of its rig; deterministic. factor: on the law's answer."""
    grid = scenario.loop.grid()
    ticks = row_ticks(grid)
    loop, span = _Loop(scenario, on, grid), ticks * grid.daq
    if factor != 1.0:
        law = loop.controller.law
        loop.controller.law = law._replace(answer=scaled(law.answer, factor))
    rows = np.empty((scenario.ticks // ticks + 1, 3))
    for row in range(len(rows)):
        begin = row * span
        loop.sample(begin, row * ticks)
        rows[row] = begin / NS, *loop.seen[WATCHED]
        if row + 1 < len(rows):
            loop.run(begin, begin + span)
    return Trace(*rows.T)


def row_ticks(grid: Sampling) -> int:
    """DAQ periods between two rows: all samples are hit, and ROWS fall into an interval, or one each DENSEST."""
    common = math.gcd(grid.sample // grid.daq, grid.offset // grid.daq)
    most = max(1, grid.sample // grid.daq // ROWS, min(DENSEST, grid.sample) // grid.daq)
    return max(n for n in range(1, most + 1) if common % n == 0)


class _Loop:
    """Plant and controller of one run."""

    def __init__(self, scenario: Scenario, on: Stand, grid: Sampling) -> None:
        self.scenario, self.grid, self.plant = scenario, grid, block_of(on.circuit)
        self.state, self.acquisition = on.rest.copy(), Acquisition(scenario)
        self.seen = np.zeros(len(OBSERVED))
        self.controller, self.hold = ControllerSide(scenario, 1), Hold(CENTRED)
        self.further = further_channels(scenario, on.circuit) if self.controller.reads_channels else None
        self.ours, self.memory = scenario.controller.kind in OURS, None
        self.target = evaluate.dispatch(type(self.controller.reference))
        self._advance(CENTRED, 0)
        self.acquisition.taps[0] = self.acquisition.taps[1]

    def sample(self, now: int, tick: int) -> None:
        """Read the card and put the answer into the hold, if this is a sampling instant."""
        if not is_sample(now, self.grid):
            return
        reading = self.acquisition.read(tick).tolist()
        sample = Sample(now, *[reading[at] for at in READ_AT], channels=self._further(tick))
        spool = self._asked(sample) if self.ours else self.controller.decide(sample)[0]
        self.hold.put(now + self.grid.delay, spool)

    def _asked(self, sample: Sample) -> float:
        """The law alone: ours prints nothing, logs nothing and keeps its numbers, as nobody changes them here."""
        own = self.controller
        target = self.target(own.reference, sample.stamp_ns / NS)
        spool, self.memory, *_ = own.law.answer(sample, target, self.memory, own.gains)
        return spool

    def _further(self, tick: int) -> Mapping[str, float]:
        if self.further is None:
            return NO_CHANNELS
        return self.controller.named(self.further.read(tick, self.state, self.seen, self.acquisition.taps).tolist())

    def run(self, begin: int, end: int) -> None:
        """The plant from one row to the next."""
        for segment in self.hold.segments(begin, end):
            self._advance(segment.value, (segment.end - segment.begin) // self.grid.step)

    def _advance(self, reference: float, steps: int) -> None:
        daq = self.scenario.daq
        reference = put_out(reference, daq.output_bits) if daq.quantise_output else reference
        self.plant(self.state, reference, steps, self.acquisition.taps, self.seen)
