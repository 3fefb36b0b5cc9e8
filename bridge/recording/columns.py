"""A run's signals on one time base, for metrics and pictures."""

import math
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.recording.reader import Recording
from bridge.recording.seen import judged
from bridge.scenario import Scenario
from bridge.scenario.courses import reference_course
from controller.course import NEVER
from controller.grid import NS
from controller.metrics import Signals
from controller.reference import Reference, evaluate
from twin.topology import CAVITIES

REMEMBERED = 8  # courses of a reference
SAME = 1e-9  # [m] between a reference as published and as evaluated again


def signals(recording: Recording, scenario: Scenario) -> Signals:
    """True signals of a run, and the reference evaluated at the same instants (NaN for a law that follows none).

    Of a measured recording those of its sensors.
    """
    state = judged(recording)
    time = state["stamp"] / NS
    return Signals(
        time=time,
        position=state["position"],
        reference=followed(recording, scenario, time),
        p1=state["p1"],
        p_lower=state["p_lower"],
        p_upper=state["p_upper"],
        spool=state["spool"],
    )


def followed(recording: Recording, scenario: Scenario, time: np.ndarray) -> np.ndarray:
    """The position reference [m] at times [s] that the run is judged against.

    A foreign controller's own where it publishes one, held from sample to sample; else the scenario's.
    """
    published = recording.columns("reference")
    stamps, positions = published["stamp"], published["position"]
    events = recording.messages("event") if "event" in recording.counts else []
    own = reference_at(stamps / NS, scenario, events)
    if not len(stamps) or np.allclose(positions, own, 0.0, SAME, equal_nan=True):
        return reference_at(time, scenario, events)
    order = np.argsort(stamps, kind="stable")
    latest = np.searchsorted(stamps[order] / NS, time + 1e-10, side="right") - 1
    return positions[order][np.maximum(latest, 0)]


def reference_at(time: np.ndarray, scenario: Scenario, events: Iterable[Any] = ()) -> np.ndarray:
    """The scenario's position reference [m] at times [s]; NaN where the law follows none.

    events: of the run, which may have changed it.
    """
    if not scenario.controller.follows:
        return np.full(len(time), np.nan)
    course = reference_course(scenario, events)
    if course.next(-1) == NEVER:  # nothing acts on it
        return _positions(scenario.reference.reference(), np.ascontiguousarray(time, dtype=np.float64).tobytes())
    return np.array([course.at(round(t * NS)).value for t in time.tolist()])


@lru_cache(REMEMBERED, typed=True)  # two kinds of reference with the same numbers are equal as tuples
def _positions(reference: Reference, times: bytes) -> NDArray[np.float64]:
    """The runs of a sweep ask for the same ones again and again. Nobody may write into it."""
    found = np.array([evaluate(reference, round(t * NS) / NS).position for t in np.frombuffer(times).tolist()])
    found.flags.writeable = False
    return found


def sine_of(scenario: Scenario) -> float:
    """The frequency [Hz] of a sine to follow; NaN for any other reference."""
    return getattr(scenario.reference, "frequency", math.nan) if scenario.controller.follows else math.nan


def vapour(state: Mapping[str, NDArray]) -> NDArray[np.float64]:
    """Volume of all cavities [m^3] at every stamp."""
    return np.sum([state[name] for name in CAVITIES if name in state], axis=0)


def relief_moved(state: Mapping[str, NDArray]) -> bool:
    """Did the relief valve open or shut?"""
    passing = state["flow_relief"] > 0.0
    return bool(passing.any() and not passing.all())
