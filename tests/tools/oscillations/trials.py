"""Runs of the labelled set, in one process, and what label and metric say of them."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.recording.columns import reference_at
from bridge.studies.stability.probe import stand_of
from bridge.studies.stability.trial import Trace, trial
from controller.metrics import Cycle, worst_cycle
from controller.stretches import held_stretches
from tests.tools.oscillations.cases import Case
from tests.tools.oscillations.labels import Label, label


class Judged(NamedTuple):
    """A run, its label and the metric."""

    case: Case
    trace: Trace
    reference: NDArray[np.float64]
    label: Label
    cycle: Cycle

    @property
    def verdict(self) -> str:
        """How the metric does: right, miss, false alarm, or doubtful where the label is."""
        found = self.cycle.amplitude > 0.0
        if found == self.label.oscillates:
            return "right"
        return "doubtful" if self.label.doubtful else "miss" if self.label.oscillates else "false alarm"


def judged(cases: Iterable[Case]) -> Iterator[Judged]:
    """Run each case and judge it twice."""
    for case in cases:
        scenario = case.scenario()
        trace = trial(scenario, stand_of(scenario))
        reference = reference_at(trace.time, scenario)
        cycle = worst_cycle(trace.time, reference - trace.position, held_stretches(reference))
        yield Judged(case, trace, reference, label(trace, reference), cycle)


def confusion(runs: Iterable[Judged]) -> dict[tuple[str, str], int]:
    """How many runs of each label the metric calls what, doubtful labels apart."""
    counts: dict[tuple[str, str], int] = {}
    for run in runs:
        row = "doubtful" if run.label.doubtful else run.label.word
        a = run.cycle.amplitude
        column = "not applicable" if a != a else "limit cycle" if a > 0.0 else "none"
        counts[row, column] = counts.get((row, column), 0) + 1
    return counts
