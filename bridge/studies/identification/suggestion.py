"""An excitation that tells wanted numbers best: for the rig's own loop, within limits of motion and pressure.

Each candidate is a table of places for the controller: steps between random places, or a sine whose frequency rises. It
is run in the closed loop of the scenario; one that leaves the limits is dropped. The recorded commands then go through
the twin as in a fit, and the Jacobian J gives what a fit would know: the candidate with the greatest determinant of
J'J + P is D-optimal among those tried (A. Atkinson, A. Donev and R. Tobias, Optimum Experimental Designs, Oxford 2007),
P of what is known before.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bridge.errors import RunError, UsageError
from bridge.loop.exchange import exchange, sides
from bridge.recording.reader import recording
from bridge.recording.writer import entries_of
from bridge.scenario import Scenario, changed, check
from bridge.scenario.circuit import in_memory
from bridge.studies.identification.data import Array
from bridge.studies.identification.parameters import Parameter, parameters_of, priors_of
from bridge.studies.identification.recorded import record_in
from bridge.studies.identification.residuals import Residuals, Task
from bridge.studies.identification.simulation import shots_of
from bridge.studies.sweep.engine import Crew, sweep
from bridge.studies.sweep.journal import Point, Result

DWELLS = ((0.08, 0.3), (0.15, 0.9), (0.5, 2.0))  # [s], ranges of the time at a place
SIZES = (0.1, 0.35, 1.0)  # of a step, shares of the room
SINES = ((0.2, 4.0), (0.5, 12.0))  # [Hz], from and to
ROWS = 50.0  # of a table of a sine [1/s]
CALM = 0.5  # [s] before it begins


class Asked(NamedTuple):
    """What is asked for; plain data."""

    scenario: Mapping[str, Any]
    fit: tuple[str, ...]
    priors: tuple[str, ...]
    duration: float  # [s]
    low: float  # places that the rod may take [m]
    high: float
    pressure: float  # greatest in the chambers and at the tee [Pa]


class Suggestion(NamedTuple):
    """The best excitation."""

    parameters: list[Parameter]
    words: str  # what it is
    table: str  # of the reference
    spread: list[float]  # standard errors of the places that a fit would state
    before: list[float]  # the same of the median of those that kept the limits
    kept: int  # candidates within the limits
    tried: int
    reached: tuple[float, float, float]  # least and greatest place [m], greatest pressure [Pa]


def suggest(asked: Asked, tries: int, part: Path | None, crew: Crew) -> Suggestion:
    """Try so many candidates. Raises UsageError when none keeps the limits."""
    parameters = parameters_of(asked.fit, check(dict(asked.scenario), "the rig"), priors_of(asked.priors))
    points = [{"seed": seed} for seed in range(tries)]
    found = sweep(
        partial(tried, asked=asked._asdict()), points, {"title": "excitations", **asked._asdict()}, part, crew
    )
    kept = [(result["score"], seed) for seed, result in enumerate(found) if result["score"] is not None]
    if not kept:
        reasons = "; ".join(sorted({result["why"] for result in found}))
        raise UsageError(f"none of {tries} excitations keeps the limits: {reasons}; allow more, or slow the loop down")
    best = found[max(kept)[1]]
    middle = found[sorted(kept)[len(kept) // 2][1]]
    return Suggestion(
        parameters, best["words"], best["table"], best["spread"], middle["spread"], len(kept), tries,
        tuple(best["reached"]),
    )  # fmt: skip


def tried(point: Point, asked: dict[str, Any]) -> Result:
    """One candidate: its score, or why it has none."""
    own = Asked(**asked)
    words, table = candidate(int(point["seed"]), own)
    with in_memory():
        scenario = excited(own, table)
        try:
            record, reached = _run(scenario)
        except RunError as error:
            return {"score": None, "why": str(error)}
        if why := _beyond(reached, own):
            return {"score": None, "why": why}
        parameters = parameters_of(own.fit, scenario, priors_of(own.priors))
        task = Task(scenario.rig_values(), scenario.loop.step, [record], parameters, shots_of([record], math.inf))
        spread, score = _known(task)
    return {"score": score, "words": words, "table": table, "spread": spread, "reached": reached, "why": ""}


def excited(asked: Asked, table: str) -> Scenario:
    """The rig in its loop, led by a table."""
    plain = {**asked.scenario, "reference": {"kind": "table", "csv": table}, "expect": [], "timeline": [], "fault": []}
    return changed(plain, [f"duration={asked.duration} s"], "excitation")


def candidate(seed: int, asked: Asked) -> tuple[str, str]:
    """What a candidate is, and its table."""
    rng = np.random.default_rng([seed, 2])
    kinds = [(dwell, size) for size in SIZES for dwell in DWELLS]
    number = seed % (len(kinds) + len(SINES))
    start = check(dict(asked.scenario), "the rig").start.position
    if number < len(kinds):
        (short, long), size = kinds[number]
        rows = _steps(rng, (short, long), size, start, asked)
        words = f"steps of up to {size:.0%} of the room, each held for {short:g} to {long:g} s"
    else:
        ends = SINES[number - len(kinds)]
        rows = _sine(rng, ends, start, asked)
        words = f"a sine from {ends[0]:g} to {ends[1]:g} Hz"
    return words, "\n".join(f"{t:.4f},{x:.5f}" for t, x in rows)


def _steps(
    rng: Any, dwell: tuple[float, float], size: float, place: float, asked: Asked
) -> Iterator[tuple[float, float]]:
    room, t = asked.high - asked.low, CALM
    yield 0.0, place
    yield t, place
    while t < asked.duration:
        place = float(np.clip(place + rng.choice([-1.0, 1.0]) * rng.uniform(0.2, 1.0) * size * room, *_inner(asked)))
        yield t + 1e-3, place
        t += float(rng.uniform(*dwell))
        yield t, place


def _sine(rng: Any, ends: tuple[float, float], place: float, asked: Asked) -> Iterator[tuple[float, float]]:
    low, high = _inner(asked)
    first, last = ends
    size = 0.5 * (high - low) * float(rng.uniform(0.1, 0.6))
    for row in range(int(asked.duration * ROWS)):
        t = row / ROWS
        share = max(0.0, t - CALM) / (asked.duration - CALM)
        turns = (first + 0.5 * (last - first) * share) * max(0.0, t - CALM)
        middle = place + (0.5 * (low + high) - place) * min(1.0, share / 0.1)
        yield t, middle + size * min(1.0, first / (first + (last - first) * share) + 0.2) * math.sin(math.tau * turns)


def _inner(asked: Asked) -> tuple[float, float]:
    """Places for references: the rod overshoots them."""
    room = asked.high - asked.low
    return asked.low + 0.1 * room, asked.high - 0.1 * room


def _run(scenario: Scenario) -> tuple[Any, list[float]]:
    """The record of a run, and where the rod and the pressures went."""
    plant, controller = sides(scenario)
    entries, places, pressures = [], [], []
    for messages in exchange(plant, controller, scenario.ticks):
        entries += entries_of([message for message in messages if message.topic != "state"])
        true = plant.true_state()
        places.append(true.position)
        pressures.append(max(true.p1, true.p_lower, true.p_upper))
    head = {"run": {"scenario": scenario.model_dump(mode="json"), "run_id": str(plant.run_id)}}
    return record_in(recording(Path("an excitation"), entries, head)), [min(places), max(places), max(pressures)]


def _beyond(reached: Sequence[float], asked: Asked) -> str:
    low, high, pressure = reached
    if low < asked.low or high > asked.high:
        return f"the rod leaves {asked.low * 1e3:g} .. {asked.high * 1e3:g} mm"
    return f"a pressure is above {asked.pressure / 1e5:g} bar" if pressure > asked.pressure else ""


def _known(task: Task) -> tuple[list[float], float]:
    """Standard errors of the places, and the logarithm of the determinant."""
    residuals, u = Residuals(task), np.zeros(len(task.parameters))
    residuals.slopes(u)  # tells how far off slopes are to be taken
    single: Array
    _, single, right = np.linalg.svd(residuals.slopes(u), full_matrices=False)
    covariance = (right.T / single**2) @ right
    return np.sqrt(np.diag(covariance)).tolist(), float(2.0 * np.log(single).sum())
