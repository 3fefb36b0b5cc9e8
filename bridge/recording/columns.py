"""A run's signals on one time base, for metrics and pictures."""

import numpy as np

from bridge.recording.reader import Recording
from bridge.scenario import Scenario
from controller.metrics import Signals
from controller.reference import evaluate
from controller.sampling import NS


def signals(recording: Recording, scenario: Scenario) -> Signals:
    """True signals of a run, and the reference evaluated at the same instants (NaN for a law that follows none)."""
    state = recording.columns("state")
    time = state["stamp"] / NS
    return Signals(
        time=time,
        position=state["position"],
        reference=reference_at(time, scenario),
        p1=state["p1"],
        p_lower=state["p_lower"],
        p_upper=state["p_upper"],
        spool=state["spool"],
    )


def reference_at(time: np.ndarray, scenario: Scenario) -> np.ndarray:
    """The scenario's position reference [m] at times [s]; NaN where the law follows none."""
    if scenario.controller.law == "open-loop":
        return np.full(len(time), np.nan)
    reference = scenario.reference.reference()
    return np.array([evaluate(reference, float(t)).position for t in time])
