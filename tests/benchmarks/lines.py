"""Lines: time of a step and of a fit, and the error against the exact line over the whole range."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tests.benchmarks.plant import Row
from tests.support.exact_line import (
    CORNERS,
    ENDS,
    HOSE,
    MIDDLE,
    PEER,
    PEER_SPAN,
    RIG,
    STEEL,
    Pipe,
    error,
)
from twin.kernel import kernel
from twin.lines.bank import Bank, arriving, bank_of, departing, memory_size, settle
from twin.lines.fit import SHORTEST
from twin.lines.spec import LOSSES

STEPS = (50e-6, 100e-6)
SIX = [
    Pipe(length, 11e-3, 40e-6, a, 878.0)
    for length, a in ((1.0, STEEL), (2.5, STEEL), (2.0, HOSE), (2.0, HOSE), (2.0, STEEL), (1.5, HOSE))
]
GOALS = {"ends": "goal 250 ns", "nodes": "", "lumped": ""}
FIT_GOAL = "goal 25 ms, worst 100 ms"


def random_pipes(count: int) -> list[Pipe]:
    """0.5 to 40 m, 8 to 20 mm, 10 to 100 mm2/s, 600 to 1330 m/s."""
    share = np.random.default_rng(7).random((count, 4))
    low, high = np.array([0.5, 8e-3, 10e-6, 600.0]), np.array([40.0, 20e-3, 100e-6, 1330.0])
    even = low + (high - low) * share
    even[:, [0, 2]] = (low * (high / low) ** share)[:, [0, 2]]
    return [Pipe(*row) for row in even.tolist()]


@kernel
def spin(bank, memory, c, z, q, source, steps: int) -> None:
    """A circuit as small as can be: a noisy source behind Z at each end 1, a load of 0.3 Z at each end 2."""
    for tick in range(steps):
        arriving(bank, memory, tick, c, z)
        for i in range(len(c) // 2):
            q[2 * i] = (source[tick & 1023] - c[2 * i]) / (2.0 * z[2 * i])
            q[2 * i + 1] = -c[2 * i + 1] / (1.3 * z[2 * i + 1])
        departing(bank, memory, tick, q)


def nanoseconds(bank: Bank, steps: int = 100_000) -> float:
    """Per step, the best of nine runs."""
    ends = 2 * len(bank.model)
    memory, c, z, q = np.zeros(memory_size(bank)), np.zeros(ends), np.zeros(ends), np.zeros(ends)
    settle(bank, memory, np.full(ends, 3e6), np.zeros(ends // 2))
    source = 3e6 + 1e5 * np.random.default_rng(0).normal(size=1024)
    best = np.inf
    for _ in range(9):
        start = time.perf_counter()
        spin(bank, memory, c, z, q, source, steps)
        best = min(best, time.perf_counter() - start)
    return best / steps * 1e9


def set_up(pipe: Pipe, model: str, step: float, friction: str = "unsteady", runs: int = 3) -> float:
    """Seconds to prepare one line, the best of some runs."""
    best = np.inf
    for _ in range(runs):
        start = time.perf_counter()
        bank_of([pipe.spec(model, friction)], step, -1e5)
        best = min(best, time.perf_counter() - start)
    return best


def rows(folder: Path) -> Iterator[Row]:
    """Speed of the rig's lines, set-up, then errors [% of the Joukowsky pressure], the worst of both ends."""
    for model, goal in GOALS.items():
        for step in STEPS:
            took = nanoseconds(bank_of([pipe.spec(model) for pipe in SIX], step, -1e5))
            yield f"six lines of the rig, {model}, {step * 1e6:g} us", f"{took:.0f} ns a step", goal, ""
        times = [set_up(pipe, model, step) for pipe in (*RIG, *CORNERS, *MIDDLE) for step in STEPS]
        yield f"set-up of a line, {model}, median", _spread(times), FIT_GOAL if model == "ends" else "", ""
    for friction in LOSSES:
        pipes = [pipe for pipe in random_pipes(300) if pipe.travel_time >= SHORTEST * 100e-6]
        times = [set_up(pipe, "ends", step, friction, 1) for pipe in pipes for step in STEPS]
        yield f"the same of 300 random lines, friction {friction}", _spread(times), FIT_GOAL, ""
    for model in ("ends", "nodes"):
        for step in STEPS:
            off = 1e2 * error(PEER, "flow", step, model, PEER_SPAN)
            yield f"{model}, {step * 1e6:g} us: 3 m line, 100 ms, rms", f"{off:.2f} %", "Hopsan 43 to 57 %", ""
        for step in STEPS:
            yield from _errors(model, step)


def _spread(times: list[float]) -> str:
    return f"{1e3 * float(np.median(times)):.1f} ms, worst {1e3 * max(times):.1f} ms"


def _errors(model: str, step: float) -> Iterator[Row]:
    """A row per line: rms over 20 travel times for a ramp of 0.5 ms at flow, pressure, shut and resistive ends."""
    worst: dict[str, list[float]] = {"M >= 8": [], "M < 8": [], "the rig's": []}
    for pipe in (*RIG, *MIDDLE, *CORNERS):
        found = [error(pipe, ends, step, model) for ends in ENDS]
        m, dn = pipe.travel_time / step, pipe.travel_time / pipe.viscous_time
        worst["M >= 8" if m >= 8.0 else "M < 8"].append(max(found))
        if pipe in RIG:
            worst["the rig's"].append(max(found))
        name = f"{pipe.length:g} m, {pipe.diameter * 1e3:g} mm, {pipe.viscosity * 1e6:g} mm2/s, {pipe.speed:g} m/s"
        yield (
            f"{model}, {step * 1e6:g} us: {name}",
            " ".join(f"{1e2 * e:.2f}" for e in found),
            f"M {m:.1f}",
            f"Dn {dn:.1e}",
        )
    if model == "ends":
        for pipe in random_pipes(150):
            m = pipe.travel_time / step
            if m >= SHORTEST:
                name = "random lines, M >= 8" if m >= 8.0 else "random lines, M < 8"
                worst.setdefault(name, []).append(max(error(pipe, ends, step, model) for ends in ENDS))
    for name, errors in worst.items():
        if errors:
            mean = 1e2 * float(np.mean(errors))
            yield f"{model}, {step * 1e6:g} us: {name}, worst", f"{1e2 * max(errors):.2f} %", f"mean {mean:.2f} %", ""
