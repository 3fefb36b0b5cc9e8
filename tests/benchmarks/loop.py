"""The closed loop as a multiple of real time: in process, and in lockstep through the real wire."""

import time
from collections.abc import Iterator
from pathlib import Path

from bridge.loop.exchange import exchange, sides
from bridge.processes.options import RunOptions
from bridge.runs.in_process import record_in_process
from bridge.runs.run import run_scenario
from bridge.scenario import load
from bridge.wire.messages import Mode
from tests.benchmarks.plant import Row

FAST = ["loop.sample_period=0.001", "loop.delay=0", "duration=10"]


def rows(folder: Path) -> Iterator[Row]:
    """All with a controller at 1 kHz."""
    scenario = load("step", FAST)
    start = time.perf_counter()
    for _ in exchange(*sides(scenario), scenario.ticks, lean=True):
        pass
    yield _row("loop in process, not recorded", scenario.duration / (time.perf_counter() - start), 50.0)
    start = time.perf_counter()
    record_in_process(scenario, folder / "a.mcap")
    yield _row("loop in process, recorded", scenario.duration / (time.perf_counter() - start), 15.0)
    long = load("step", [*FAST[:2], "duration=20"])
    seconds = [_lockstep(s, folder / f"{s.duration:g}.mcap") for s in (scenario, long)]
    yield _row("loop in lockstep, three processes, recorded", 10.0 / (seconds[1] - seconds[0]), 5.0)


def _lockstep(scenario, path: Path) -> float:
    """Wall seconds of a whole run; the difference of two lengths is free of the start."""
    start = time.perf_counter()
    outcome = run_scenario(scenario, RunOptions(Mode.LOCKSTEP, path))
    assert not outcome.faults, outcome.faults
    return time.perf_counter() - start


def _row(words: str, speed: float, goal: float) -> Row:
    return words, f"{speed:.1f} x real time", f"goal {goal:g}", f"{speed / goal:.2f}"
