"""Rigs drawn at random: ranges of a scenario's numbers, and the scenario of an episode."""

import math
from collections.abc import Iterator, Mapping
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from bridge.errors import ScenarioError, UsageError, nearest
from bridge.scenario import Scenario
from bridge.scenario.circuit import in_memory, rest_of
from bridge.scenario.loading import changed
from controller.grid import NS

SECTIONS = ("start", "daq", "reference", "rig")
DELAY = "loop.delay"
SEED = "seed"  # of the noise: drawn anew for every episode
Numbers = dict[str, float]


class Range(NamedTuple):
    """What a number is drawn from, evenly."""

    key: str
    low: float  # SI
    high: float

    def draw(self, random: np.random.Generator, step: float) -> float:
        """A number of the range; a delay is a whole number of internal steps [s]."""
        value = float(random.uniform(self.low, self.high))
        return round(round(value / step) * step * NS) / NS if self.key == DELAY else value


def ranges_of(scenario: Scenario, asked: Mapping[str, Any]) -> list[Range]:
    """Ranges such as {"rig.load.mass": (120, 303), "loop.delay": ("0 ms", "10 ms")}. Raises UsageError."""
    return [_range(scenario, key, ends) for key, ends in asked.items()]


def _range(scenario: Scenario, key: str, ends: Any) -> Range:
    refuse_key("randomise", key)
    if not isinstance(ends, tuple | list) or len(ends) != 2:
        raise UsageError(f"randomise {key!r}: {ends!r:.40} is not a range; give (low, high), such as (120, 303)")
    low, high = (_end(scenario, key, end) for end in ends)
    if not low <= high:
        raise UsageError(f"randomise {key!r}: the range {ends[0]!r} to {ends[1]!r} must rise")
    return Range(key, low, high)


def refuse_key(option: str, key: str) -> None:
    """Raises UsageError for a number that belongs to another environment and not to another rig."""
    if key != DELAY and (key.partition(".")[0] not in SECTIONS or "." not in key):
        near = nearest(key.partition(".")[0], [*SECTIONS, DELAY])
        raise UsageError(f"{option} {key!r}: not a number of the rig, its sensors, its start or the reference{near}")


def _end(scenario: Scenario, key: str, end: Any) -> float:
    """One end of a range in SI; with it the scenario must be sound, and the rig must have a state at rest."""
    try:
        ours = with_changes(scenario, {key: end})
        with in_memory():
            rest_of(ours)
    except ScenarioError as error:
        raise UsageError(f"randomise {key!r}: {' '.join(str(error).split())}") from None
    found = reduce(getattr, key.split("."), ours)
    if not isinstance(found, float) or not math.isfinite(found):
        raise UsageError(f"randomise {key!r}: {end!r} is not a finite number, from which to draw")
    return found


def with_changes(scenario: Scenario, changes: Mapping[str, Any]) -> Scenario:
    """The scenario with some numbers changed, checked again. Raises ScenarioError."""
    if not changes.keys() - {SEED}:
        return scenario.model_copy(update=dict(changes))
    words = [f"{key}={value if isinstance(value, str) else repr(value)}" for key, value in changes.items()]
    return changed(scenario.model_dump(mode="json"), words, scenario.name)


def drawn(ranges: list[Range], random: np.random.Generator, step: float) -> Iterator[tuple[str, float]]:
    """A number of each range."""
    for asked in ranges:
        yield asked.key, asked.draw(random, step)
