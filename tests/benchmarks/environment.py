"""The environment for learning: steps per second of one core, beside the bare loop with the same commands."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from bridge.loop.exchange import exchange, sides
from bridge.scenario import Scenario, load
from controller.laws import ControlLaw
from hydrotwin.gym import Rig
from tests.benchmarks.plant import Row

ROUNDS = 10  # of each, by turns
CHANGES = {"duration": 3}
RIGS = {"rig.load.mass": (120, 303), "loop.delay": ("0 ms", "10 ms")}
ACTION = np.array([0.2], np.float32)


def rows(folder: Path) -> Iterator[Row]:
    """Steps of 10 ms, each of ten ticks; then what a new rig costs."""
    scenario, env = load("step", ["duration=3"]), Rig("step", CHANGES, bands=["p1 <= 120 bar"])
    bare, ours = by_turns(lambda: _bare(scenario), lambda: _episode(env))
    words = f"{ours:.0f} steps a second, {ours * scenario.loop.sample_period:.0f} x real time"
    yield "environment, one core", words, f"bare loop {bare:.0f}", f"{ours / bare:.2f}"
    for name, randomise in {"same rig": {}, "mass and delay": RIGS, "oil": {"rig.oil.temperature": (30, 50)}}.items():
        yield f"reset, {name}", f"{_reset(Rig('step', CHANGES, randomise=randomise)) * 1e3:.1f} ms", "", ""


def by_turns(*works: Callable[[], int]) -> list[float]:
    """Greatest number per second of CPU of each work, which returns how many it has done."""
    best = [0.0] * len(works)
    for _ in range(ROUNDS):
        for at, work in enumerate(works):
            start = time.process_time()
            best[at] = max(best[at], work() / (time.process_time() - start))
    return best


def _bare(scenario: Scenario) -> int:
    law = ControlLaw(lambda sample, target, memory, gains: (0.2, memory))
    for _ in exchange(*sides(scenario, law), scenario.ticks, lean=True):
        pass
    return round(scenario.duration / scenario.loop.sample_period)


def _episode(env: Rig) -> int:
    env.reset()
    steps, over = 0, False
    while not over:
        over, steps = env.step(ACTION)[3], steps + 1
    return steps


def _reset(env: Rig, times: int = 20) -> float:
    """CPU seconds of a reset."""
    env.reset(seed=1)
    start = time.process_time()
    for _ in range(times):
        env.reset()
    return (time.process_time() - start) / times
