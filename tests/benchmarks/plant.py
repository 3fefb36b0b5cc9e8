"""The whole circuit on one core: simulated seconds per wall second, where the time goes, and how even the blocks are.

The limit is what a step must do in turn. The lines' ends are moved side by side, as vectors, and take a third. The
relief valve, another third, moves two bodies on stiff oil with substeps of their own, more of them where the step would
turn the poppet's swing too far: that is why twice the step is not twice as fast. The rest is scalar, with a root or a
power at each of pump, lands, cylinder and seal, and each waits for the one before it. The call of a block costs about
as much as two steps and is shared by twenty, or by ten at 100 us.
"""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from twin.circuit.block import block_of, buffers, compiled
from twin.circuit.build import build
from twin.circuit.equilibrium import equilibrium
from twin.circuit.state import MEMORY_AT, ends_of, flatten
from twin.kernel import kernel
from twin.lines.bank import arriving, departing, unpacked
from twin.rig import values

Row = tuple[str, str, str, str]
GOALS = {50e-6: 125.0, 100e-6: 250.0}  # times real time, whatever the valve does
BLOCK = 1e-3  # [s]
BLOCKS = 20_000
QUICK = 0.1e-3  # [s], of wall time for a block
SWING = 200  # blocks from throw to throw
RUNS = 40  # short ones, of which the best counts


class Plant:
    """The rig with some values changed, at rest, and what a block needs."""

    def __init__(self, step: float, **changes: dict[str, str | float]) -> None:
        circuit = build(values(changes), step)
        self.circuit, self.compiled = circuit, compiled(circuit)
        self.run = block_of(self.compiled)
        self.state = flatten(equilibrium(circuit, 0.13))
        self.taps, self.seen = buffers()
        self.steps = round(BLOCK / step)
        self.advance(0.0)

    def advance(self, spool: float) -> None:
        """A block."""
        self.run(self.state, spool, self.steps, self.taps, self.seen)


@kernel
def lines_alone(state, whole, numbers, first: int, steps: int) -> None:
    """What a step does for the lines, the flows at their ends held."""
    bank, ends, memory = unpacked(whole, numbers), ends_of(state), state[MEMORY_AT:]
    for tick in range(first, first + steps):
        arriving(bank, memory, tick, ends.free, ends.impedance)
        departing(bank, memory, tick, ends.flow)


def block_times(plant: Plant, spool: float, blocks: int) -> NDArray[np.float64]:
    """Wall time [s] of each block, the spool thrown from end to end when asked to."""
    took = np.empty(blocks)
    for k in range(blocks):
        reference = spool * (1.0 if k // SWING % 2 else -1.0)
        start = time.perf_counter()
        plant.advance(reference)
        took[k] = time.perf_counter() - start
    return took


def per_step(plant: Plant, spool: float = 0.0) -> float:
    """Seconds a step, over a throw up and down."""
    return float(block_times(plant, spool, 2 * SWING).mean()) / plant.steps


def lines_per_step(plant: Plant, steps: int = 10_000) -> float:
    """Seconds a step of the lines alone, on a copy of the state."""
    state, first = plant.state.copy(), int(plant.state[0]) + 1
    lines_alone(state, plant.compiled.whole, plant.compiled.numbers, first, 1)  # compiled before the clock starts
    start = time.perf_counter()
    lines_alone(state, plant.compiled.whole, plant.compiled.numbers, first + 1, steps)
    return (time.perf_counter() - start) / steps


def call_per_step(plant: Plant, calls: int = 2000) -> float:
    """Seconds a step of a call without one, its arguments unpacked and what is observed, shared by a block."""
    start = time.perf_counter()
    for _ in range(calls):
        plant.run(plant.state, 0.0, 0, plant.taps, plant.seen)
    return (time.perf_counter() - start) / calls / plant.steps


def best(*measures: Callable[[], float]) -> list[float]:
    """The least of each, taken in turns: they meet the same load of the machine, which is not ours alone."""
    return [min(found) for found in zip(*([measure() for measure in measures] for _ in range(RUNS)), strict=True)]


def rows(folder: Path) -> Iterator[Row]:
    """Times real time, the parts of a step, and the blocks."""
    for step, goal in GOALS.items():
        plant, swung, bare = Plant(step), Plant(step), Plant(step, relief={"kind": "none"})
        whole, swinging, unrelieved, lines, call = best(
            lambda plant=plant: per_step(plant),
            lambda plant=swung: per_step(plant, 1.0),
            lambda plant=bare: per_step(plant),  # the pump's leakage takes all
            lambda plant=plant: lines_per_step(plant),
            lambda plant=plant: call_per_step(plant),
        )
        for words, took in (("valve shut, relief valve at work", whole), ("valve swinging fully", swinging)):
            name, speed = f"full circuit, {step * 1e6:g} us, {words}", step / took
            yield name, f"{speed:.0f} x real time", f"goal {goal:g} x", f"{speed / goal:.2f}"
        yield (
            f"a step of {step * 1e6:g} us, valve shut",
            f"{whole * 1e9:.0f} ns",
            f"goal {step / goal * 1e9:.0f} ns",
            "",
        )
        parts = {"six lines": lines, "relief valve at work": whole - unrelieved, "its share of the call": call}
        parts["the rest"] = unrelieved - lines - call
        for name, took in parts.items():
            yield f"of it {name}", f"{took * 1e9:.0f} ns", f"{took / whole:.0%}", ""
    yield from _blocks()


def _blocks() -> Iterator[Row]:
    """20,000 blocks of 1 ms at 50 us as the plant process calls them; single ones wait for the machine's other load."""
    for words, spool in (("valve shut", 0.0), ("valve swinging fully", 1.0)):
        took = block_times(Plant(50e-6), spool, BLOCKS)
        share, slow = float(np.mean(took < QUICK)), float(np.percentile(took, 99.9))
        yield f"blocks of 1 ms, {words}: below 0.1 ms", f"{share:.3%}", "goal 99.9 %", f"{share / 0.999:.3f}"
        yield (
            f"blocks of 1 ms, {words}: p99.9",
            f"{slow * 1e6:.0f} us",
            f"goal {QUICK * 1e6:.0f} us",
            f"{QUICK / slow:.2f}",
        )
