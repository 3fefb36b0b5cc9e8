"""Sweeps: runs of the twin in a second on a core, beside Hopsan's 72 ms for a run of 10 s of a circuit like ours; and
what `hydrotwin sweep` takes for its runs, beside the loop alone in process.
"""

import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from bridge.loop.exchange import exchange, sides
from bridge.runs.in_process import run_in_memory
from bridge.runs.sweep.axes import axes_of
from bridge.runs.sweep.sweep import Wanted, run_sweep
from bridge.scenario import Scenario, load
from bridge.scenario.measures import measures_of
from bridge.studies.stability.probe import critical_gain
from bridge.studies.stability.trial import stand, trial
from tests.benchmarks.plant import Row

HOPSAN = 72e-3  # [s], a run of 10 s at 0.1 ms, six friction hoses, by its C API
LUMPED = [f"rig.pipe_{number}.model=lumped" for number in range(1, 7)]
CASES = {"six lines of model ends": [], "lumped lines": LUMPED}


def seconds(changes: list[str], step: float, runs: int = 7) -> float:
    """For a run of 10 s, the best of some."""
    scenario = load("step", ["duration=10", f"loop.step={step}", *changes])
    on, best = stand(scenario), float("inf")
    trial(scenario, on)
    for _ in range(runs):
        start = time.perf_counter()
        trial(scenario, on)
        best = min(best, time.perf_counter() - start)
    return best


def rows(folder: Path) -> Iterator[Row]:
    """Runs of the step scenario, controller sampled every 10 ms."""
    for name, changes in CASES.items():
        for step in (50e-6, 100e-6):
            took = seconds(changes, step)
            words = f"{1.0 / took:.1f} runs of 10 s a second, {took * 1e3:.0f} ms each"
            yield f"sweep, {name}, {step * 1e6:g} us", words, "Hopsan, 100 us: 72 ms", f"{HOPSAN / took:.2f}"
    scenario = load("step", ["loop.delay=0.0", "loop.sample_period=0.1"])
    critical_gain(scenario, 36.0)
    start = time.perf_counter()
    critical_gain(scenario, 36.0)
    yield "an edge at 100 ms, to 1 %", f"{time.perf_counter() - start:.2f} s", "", ""
    yield from against_the_loop()


MEASURES = ["rms error, overshoot, peak p_lower, rms error from 0.5 s to end"]
ROUNDS, GAINS = 5, 8


def against_the_loop() -> Iterator[Row]:
    """Runs of a sweep on one core, journal included, beside the same scenario run alone; turn by turn, medians."""
    for duration in (1, 10):
        scenario = load("step", [f"duration={duration}"])
        wanted = Wanted(scenario, axes_of([f"controller.gain=0.5:4:{GAINS}"], scenario), measures_of(MEASURES))
        rounds = [_round(wanted, scenario) for _ in range(ROUNDS + 1)][1:]
        swept, recorded, lean = np.median(np.array(rounds), axis=0).tolist()
        words = f"hydrotwin sweep, runs of {duration} s, one core"
        ours = f"{1.0 / swept:.1f} runs a second"
        yield words, ours, f"in memory with all messages: {1.0 / recorded:.1f}", f"{recorded / swept:.2f}"
        yield words, ours, f"messages made, none kept: {1.0 / lean:.1f}", f"{lean / swept:.2f}"


def _round(wanted: Wanted, scenario: Scenario) -> tuple[float, float, float]:
    """Processor seconds for a run: of the sweep, of a run in memory, of the bare loop."""
    with tempfile.TemporaryDirectory() as folder:
        swept = _timed(lambda: run_sweep(wanted, Path(folder))) / GAINS
    recorded = _timed(lambda: run_in_memory(scenario))
    return swept, recorded, _timed(lambda: [None for _ in exchange(*sides(scenario), scenario.ticks)])


def _timed(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start
