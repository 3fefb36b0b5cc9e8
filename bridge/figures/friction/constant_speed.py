"""The friction test of 2.3 on the twin: open-loop references just beyond the overlap, five loads, up and down.

Where the speed is constant the forces balance, F_f = A_l p_l - A_u p_u - m g, so pressures tell the friction.
Speeds are constant only in part: friction falls with speed, and what damps the piston is the lands' flow-pressure
slope G, against the elastic oil C behind it; a speed is steady where about G/C > |dF_f/dv|/m. Between the rig's
hoses that is beyond some 40 mm/s; with the valve on the cylinder, 0.2 m of steel pipe between them, beyond some
20 mm/s: both are run. Slower, the piston sticks and slips, and a balance of means tells nothing of the law.
The pump gives its mean flow: with the ripple of its teeth the speed swings by 1 to 2 %, and no speed on the way up
is constant within SPREAD.
"""

from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.drawing.canvas import Array
from bridge.scenario.model import Daq
from twin.circuit.block import block_of, buffers, compiled
from twin.circuit.build import build
from twin.circuit.equilibrium import equilibrium
from twin.circuit.kinds import of_kind
from twin.circuit.state import flatten
from twin.circuit.step import Circuit
from twin.load import Load
from twin.rig import rig_number, values
from twin.sensors import Card, acquire, card_of, noise_block
from twin.spool_valve import SpoolValve
from twin.topology import CHANNELS

LOADS = (165.0, 213.0, 243.0, 299.0, 334.0)  # [kg], 2.3
BEYOND = (0.002, 0.005, 0.008, 0.011, 0.016, 0.02, 0.025, 0.03, 0.04, 0.05, 0.065)  # the overlap; share of the travel
NEAR = 0.2  # [m], assumed: from the valve on the cylinder to its chambers
STEEL = {name: rig_number("pipe_1", name) for name in ("wall", "young")}
MOUNTED = {"length": NEAR, "model": "lumped", **STEEL}  # 3.5 steps of a wave, too short for `ends`
LINES = {rig_number("pipe_3", "length"): {}, NEAR: {"pipe_3": MOUNTED, "pipe_4": MOUNTED}}
SMOOTH = {"pump": {"ripple": "none"}}
START = {1.0: 0.03, -1.0: 0.24}  # [m], by direction: room to run
STEP = 50e-6  # [s]
SETTLING = 12_000  # steps before the first window: 0.6 s
SAMPLE = 100  # steps: 5 ms
SAMPLES = 80  # a window of 0.4 s
WINDOWS = 3  # at most: the first steady one is read, else the last
SPREAD = 0.01  # largest standard deviation of a constant speed, share of its mean
REST = 1e-5  # [m/s], slower is at rest
STEADY, UNSTEADY, RESTING, OUT_OF_RANGE = 0.0, 1.0, 2.0, 3.0  # what a run shows; only the first tells the friction
LEAST_PRESSURE = 0.1e5  # [Pa], less is the end of a transducer's range: the card reads no vacuum
CARD = card_of(Daq())
POSITION, VELOCITY, LOWER, UPPER = ([*CHANNELS].index(name) for name in ("position", "velocity", "p2", "p3"))
SEED = 24


class SpeedRun(NamedTuple):
    """One run, before it is read."""

    line: float  # between valve and cylinder [m]
    mass: float  # [kg]
    reference: float  # of the spool, -1..1
    circuit: Circuit
    taps: NDArray[np.float64]  # true values in the window: sample, (a step before, then), channel


class Readings(NamedTuple):
    """Means over the window, an entry per run."""

    line: Array  # between valve and cylinder [m]
    mass: Array  # [kg]
    reference: Array  # of the spool, -1..1
    speed: Array  # v [m/s], the slope of the position
    spread: Array  # standard deviation of the true speed [m/s]
    p_lower: Array  # p_l = p2 [Pa]
    p_upper: Array  # p_u = p3 [Pa]
    force: Array  # F_f [N], by the balance
    verdict: Array  # STEADY, UNSTEADY, RESTING or OUT_OF_RANGE

    @property
    def steady(self) -> NDArray[np.bool_]:
        return self.verdict == STEADY

    @property
    def sealing(self) -> Array:
        """p_w [Pa]."""
        return np.abs(self.p_lower - self.p_upper)


def bench(line: float, mass: float) -> Circuit:
    """The rig with a load [kg] and one of LINES [m] between valve and cylinder."""
    return build(values({**LINES[line], **SMOOTH, "load": {"mass": mass}}), STEP)


def window_of(reference: float, direction: float, circuit: Circuit) -> NDArray[np.float64]:
    """Taps (sample, 2, channel) in the first steady window at a spool reference, or in the last one."""
    run, state = block_of(compiled(circuit)), flatten(equilibrium(circuit, START[direction]))
    tap, seen = buffers()
    taps = np.stack([tap] * SAMPLES)
    run(state, reference, SETTLING, taps[0], seen)
    for _ in range(WINDOWS):
        for sample in taps:
            run(state, reference, SAMPLE, sample, seen)
        if verdict(taps) == STEADY:
            break
    return taps


def verdict(taps: NDArray[np.float64]) -> float:
    """What a window shows, by the true speed."""
    speed = taps[:, 1, VELOCITY]
    if abs(speed.mean()) < REST:
        return RESTING
    return STEADY if speed.std() <= SPREAD * abs(speed.mean()) else UNSTEADY


@cache
def runs() -> list[SpeedRun]:
    """All runs: lines, loads, references, up and down."""
    made = []
    for line, mass in product(LINES, LOADS):
        circuit = bench(line, mass)
        for beyond, direction in product(BEYOND, START):
            reference = direction * (of_kind(circuit.parts.valve, SpoolValve).overlap + beyond)
            made.append(SpeedRun(line, mass, reference, circuit, window_of(reference, direction, circuit)))
    return made


def scan(taps: NDArray[np.float64], card: Card | None, block: int) -> NDArray[np.float64]:
    """What the card reads in a window: sample, channel. block: of the noise; card None: the true values."""
    if card is None:
        return taps[:, 1]
    out = np.empty((len(taps), len(CHANNELS)))
    for sample, noise, row in zip(taps, noise_block(SEED, block), out, strict=False):
        acquire(sample, noise, card, STEP, row)
    return out


def read(run: SpeedRun, card: Card | None, block: int) -> tuple[float, ...]:
    """A row of Readings."""
    samples = scan(run.taps, card, block)
    speed = np.polyfit(np.arange(SAMPLES) * SAMPLE * STEP, samples[:, POSITION], 1)[0]
    lower, upper = samples[:, [LOWER, UPPER]].mean(axis=0)
    cylinder, load = run.circuit.parts.cylinder, of_kind(run.circuit.parts.load, Load)
    force = cylinder.area_lower * lower - cylinder.area_upper * upper - load.mass * load.gravity
    shown = verdict(run.taps)
    if card is not None and shown == STEADY and upper < LEAST_PRESSURE:
        shown = OUT_OF_RANGE
    return run.line, run.mass, run.reference, speed, run.taps[:, 1, VELOCITY].std(), lower, upper, force, shown


@cache
def readings(carded: bool = True) -> Readings:
    """The test as the card reads it, or as it is."""
    card = CARD if carded else None
    return Readings(*np.array([read(run, card, block) for block, run in enumerate(runs())]).T)
