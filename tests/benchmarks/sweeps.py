"""Sweeps: runs of the twin in a second on a core, beside Hopsan's 72 ms for a run of 10 s of a circuit like ours."""

import time
from collections.abc import Iterator
from pathlib import Path

from bridge.scenario import load
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
