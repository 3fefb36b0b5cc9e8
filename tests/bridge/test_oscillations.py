"""A dozen runs of the labelled set: the metric says what the motion of the true position says."""

from typing import Any

import pytest

from tests.tools.oscillations.cases import labelled_cases
from tests.tools.oscillations.trials import confusion, judged

SHORT = (1, 10, 18, 31, 39, 48, 55, 58, 76, 78, 82, 87, 91)  # of each kind, and what was hardest


def missed(chosen: Any) -> list[str]:
    """Runs that the metric misjudges."""
    return [f"{run.verdict}: {run.case.name}" for run in judged(chosen) if run.verdict in ("miss", "false alarm")]


def test_a_dozen_runs_of_the_labelled_set():
    cases = labelled_cases()
    runs = list(judged(cases[i] for i in SHORT))
    assert [f"{run.verdict}: {run.case.name}" for run in runs if run.verdict in ("miss", "false alarm")] == []
    counts = confusion(runs)
    assert counts["oscillates", "limit cycle"] >= 4
    assert sum(count for (_, found), count in counts.items() if found == "none") >= 5
    assert counts["no stretch", "not applicable"] == 1


@pytest.mark.endurance
@pytest.mark.timeout(900)
def test_the_whole_labelled_set():
    assert len(labelled_cases()) >= 60
    assert missed(labelled_cases()) == []
