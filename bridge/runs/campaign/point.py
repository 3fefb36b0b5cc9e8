"""One run of a campaign: plain data in, plain data out, so that any process can do it and a journal can keep it."""

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from bridge.errors import RunError, UsageError
from bridge.processes.options import RunOptions
from bridge.recording.reader import Recording, read
from bridge.recording.summary import Summary
from bridge.recording.verdict import verdict
from bridge.runs.campaign.made import Plain, scenario_of
from bridge.runs.check import judge_run
from bridge.runs.measures import values_of
from bridge.runs.run import run_scenario
from bridge.runs.sweep.point import run_alone
from bridge.runs.tune.goal import MOST, limit_of
from bridge.scenario import Scenario
from bridge.scenario.measures import measure
from bridge.studies.sweep.journal import Point, Result
from bridge.wire.messages import Mode

Ran = tuple[Recording, Summary, list[str]]  # with what went wrong


def judged(
    point: Point, bases: Mapping[str, Plain], pieces: Mapping[str, Plain], measures: Sequence[str], mode: str
) -> Result:
    """What one run comes to.

    point: see `scenario_of`. The result has a `reason` why the run failed ("" for none), its `bands`, and `values` of
    the measures in SI, None where the run has none.
    """
    try:
        scenario = scenario_of(point, bases, pieces)
    except UsageError as error:
        return _without(measures, _line(error))
    with tempfile.TemporaryDirectory(prefix="hydrotwin-") as folder:
        try:
            found, summary, faults = _ran(scenario, Mode(mode), Path(folder) / "run.mcap")
        except (UsageError, RunError) as error:
            return _without(measures, _line(error))
        asked = [measure(words) for words in measures]
        values = values_of(asked, scenario, summary, found)
        return {"reason": faults[0] if faults else "", "bands": bands_of(scenario, summary, found), "values": values}


def _ran(scenario: Scenario, mode: Mode, path: Path) -> Ran:
    if mode == Mode.INPROCESS:
        found, summary = run_alone(scenario)
        return found, summary, verdict(summary, scenario)
    outcome = run_scenario(scenario, RunOptions(mode, path))
    if outcome.summary is None:
        raise RunError("; ".join(outcome.faults))
    return read(path), outcome.summary, outcome.faults


def bands_of(scenario: Scenario, summary: Summary, found: Recording) -> list[Plain]:
    """Each band of a scenario and how it went."""
    limits = [limit_of(expected.band) for expected in scenario.expected]
    values = values_of([limit.measure for limit in limits], scenario, summary, found)
    verdicts = judge_run(scenario, summary, found)
    return [
        {
            "band": one.text,
            "id": one.id,
            "text": one.requirement,
            "found": one.found,
            "passed": one.passed,
            "value": value,
            "excess": 0.0 if one.passed else limit.violation(value) or MOST,
        }
        for one, limit, value in zip(verdicts, limits, values, strict=True)
    ]


def _without(measures: Sequence[str], reason: str) -> Result:
    return {"reason": reason, "bands": [], "values": [None for _ in measures]}


def _line(error: Exception) -> str:
    return "; ".join(str(error).splitlines())
