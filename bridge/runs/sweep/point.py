"""One run of a sweep: plain data in, plain data out, so that any process can do it and a journal can keep it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bridge.errors import RunError, UsageError
from bridge.recording.reader import Recording
from bridge.recording.summary import Summary, summary_of
from bridge.recording.verdict import verdict
from bridge.runs.check import judge_run
from bridge.runs.in_process import record_in_process, run_unrecorded
from bridge.runs.measures import values_of
from bridge.scenario import Scenario, changed
from bridge.scenario.measures import measure
from bridge.studies.sweep.journal import Point, Result


def run_of(
    point: Point, base: Mapping[str, Any], which: str, measures: Sequence[str], judge: bool = False, keep: str = ""
) -> Result:
    """What a run with some changes comes to.

    point: `changes`, and the `name` of its recording if one is kept in the folder `keep`. The result has `values` in SI
    (None where the run has none), a `reason` why a run has none at all, and with `judge` the bands that `failed`.
    """
    asked = [measure(words) for words in measures]
    try:
        scenario = changed(dict(base), point["changes"], which)
        found, summary = run_alone(scenario, Path(keep) / point["name"] if keep else None)
    except (UsageError, RunError) as error:
        return _without(asked, "; ".join(str(error).splitlines()))
    if faults := verdict(summary, scenario):
        return _without(asked, faults[0])
    failed = [one.words for one in judge_run(scenario, summary, found) if not one.passed] if judge else []
    return {"values": values_of(asked, scenario, summary, found), "reason": "", "failed": failed}


def run_alone(scenario: Scenario, path: Path | None = None) -> tuple[Recording, Summary]:
    """A run in this process, recorded where there is a path for it. Raises RunError."""
    if path is None:
        return run_unrecorded(scenario)
    found = record_in_process(scenario, path)
    summary = summary_of(found)
    assert summary is not None
    return found, summary


def _without(asked: Sequence[Any], reason: str) -> Result:
    return {"values": [None for _ in asked], "reason": reason, "failed": []}
