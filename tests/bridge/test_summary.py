"""The summary of a run: the values with types and the plain data of recordings say the same, whoever wrote them."""

import json
import math
from pathlib import Path

import pytest

from bridge.recording.info import describe
from bridge.recording.reader import Recording, read
from bridge.recording.summary import (
    CommandSummary,
    OverrunTotals,
    Spread,
    Summary,
    TimingSummary,
    summary_of,
)
from bridge.recording.words import run_in_words
from bridge.report.difference import metric_rows
from bridge.report.sections import timing_table
from bridge.report.subject import load_run
from controller.bands import Metrics

GOLDEN = Path(__file__).parents[2] / "recordings" / "step.mcap"
TIMED = Summary(
    scenario="step",
    ending="complete after 1000 ticks",
    simulated=1.0,
    metrics=Metrics(*(float(i) if i % 3 else math.nan for i in range(len(Metrics._fields)))),
    timing=TimingSummary(
        Spread(1e-5, 2e-5, 3e-5, 4e-5), Spread(1e-4, 2e-4, 3e-4, 4e-4), None, OverrunTotals(3, 0.02, 2, 7)
    ),
    commands=CommandSummary(100, 2, 1.5e-3, {"stale": 4}, 100, 96),
    safe_states=0,
    lost={"timing": 2},
    messages={"state": 1001},
    rejected=5,
    first={"late": "at 0.1 s: acted 1.5 ms late"},
)


@pytest.fixture(scope="module")
def golden() -> Recording:
    return read(GOLDEN)


def test_a_recording_s_summary_comes_back_key_by_key_in_its_order(golden):
    written = golden.metadata["summary"]
    again = Summary.from_plain(written).plain()
    later = {name: value for name, value in again["metrics"].items() if name not in written["metrics"]}
    assert set(later.values()) <= {None}  # metrics that its version did not know
    known = {name: again["metrics"][name] for name in written["metrics"]}
    assert json.dumps(again | {"metrics": known}) == json.dumps(written)
    assert again["metrics"]["rise_time"] > 0.0


def test_a_run_with_a_clock_comes_back():
    plain = TIMED.plain()
    assert json.dumps(Summary.from_plain(json.loads(json.dumps(plain))).plain()) == json.dumps(plain)
    assert list(plain["timing"]) == ["lateness", "cost", "round_trip", "overruns"]
    assert plain["timing"]["lateness"] == {"p50": 1e-5, "p99": 2e-5, "p99.9": 3e-5, "max": 4e-5}
    assert plain["timing"]["round_trip"] == {}
    assert plain["timing"]["overruns"] == {"count": 3, "worst": 0.02, "burst": 2, "ticks": 7}
    assert plain["metrics"]["rise_time"] is None
    assert list(plain)[-2:] == ["rejected", "first"]


@pytest.mark.parametrize("entry", TIMED.plain())
@pytest.mark.parametrize("wrong", [None, [], "?", {"p50": "?"}, True], ids=repr)
def test_what_a_recording_lacks_or_says_wrongly_does_not_hinder_reading_it(golden, entry, wrong):
    """MCAP has no checksum for these facts, and older recordings have fewer of them."""
    facts = (
        TIMED.plain() | {entry: wrong} if wrong is not None else {k: v for k, v in TIMED.plain().items() if k != entry}
    )
    summary = Summary.from_plain(json.loads(json.dumps(facts)))
    kept = {name: value for name, value in summary.plain().items() if name != entry}
    assert kept == {name: value for name, value in TIMED.plain().items() if name != entry}
    recording = golden._replace(metadata=golden.metadata | {"summary": facts})
    assert describe(recording).summary == summary
    assert run_in_words(recording)


def test_a_report_on_a_run_without_metrics_and_clock_has_no_rows_of_them():
    run = load_run(GOLDEN)
    bare = run._replace(summary=run.summary._replace(metrics=None, timing=None))
    assert metric_rows([bare]) == []
    assert "us</td>" not in timing_table([bare], ["a"])
    timed = run._replace(summary=run.summary._replace(timing=TIMED.timing))
    assert "40.0 us</td>" in timing_table([timed], ["a"])


def test_a_recording_without_a_summary_says_so(golden):
    assert summary_of(golden._replace(metadata={})) is None
