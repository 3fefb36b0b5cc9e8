"""What makes a run good is the same in every mode; a bad one exits with 1, and its main reason comes first."""

import json
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import pytest

from bridge.loop.exchange import exchange, sides
from bridge.recording.info import problems
from bridge.recording.reader import read
from bridge.recording.summary import CommandSummary, OverrunTotals, Spread, Summary, TimingSummary
from bridge.recording.verdict import verdict
from bridge.report.subject import load_run
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire.messages import Outgoing
from tests.support.command import hydrotwin_here
from tests.support.processes import UNDRAWN, hydrotwin

LAW = "def law(sample, target, memory, gains):\n    {}\n"
BAD_LAWS = {  # what it answers, and how the first line begins
    "return 3.0, memory": "FAILED: the plant refused 30 commands (30 out of range; the first at",
    "return float('nan'), memory": "FAILED: the plant refused 30 commands (30 not finite; the first at",
    "return 1 / 0, memory": "FAILED: controller.law './mine.py:law': mine.py, line 2: ZeroDivisionError",
}
QUICK = (
    "--duration",
    "0.29 s",
    "--set",
    "controller.kind=python",
    "--set",
    "controller.law=./mine.py:law",
    "--record",
    "a.mcap",
)
TIMED = TimingSummary(Spread(0.0, 0.0, 0.0, 0.0), None, None, OverrunTotals(3, 0.02, 9, 20))
GOOD = Summary(
    scenario="step",
    ending="complete after 1000 ticks",
    simulated=1.0,
    metrics=None,
    timing=TIMED,
    commands=CommandSummary(101, 1, 1.5e-3, {}, 100, 100),
    safe_states=0,
    lost={},
    messages={},
)


@pytest.mark.parametrize("body", BAD_LAWS)
def test_a_law_that_answers_nonsense_fails_the_run(tmp_path: Path, body: str):
    (tmp_path / "mine.py").write_text(LAW.format(body))
    done = hydrotwin_here("run", "step", "--mode", "inprocess", *QUICK, cwd=tmp_path)
    assert done.returncode == 1
    assert done.stdout.splitlines()[0].startswith(BAD_LAWS[body])
    assert "Traceback" not in done.stdout + done.stderr


@pytest.mark.parametrize("mode", ["lockstep", "realtime"])
def test_refusals_fail_a_run_of_processes_in_the_same_words(tmp_path: Path, mode: str):
    """In lockstep a bad answer is an answer: the run goes to its end as in process, and each one is counted."""
    (tmp_path / "mine.py").write_text(LAW.format("return 3.0, memory"))
    done = hydrotwin("run", "step", "--mode", mode, *QUICK, *UNDRAWN, "--set", "real_time.overruns=1.0", cwd=tmp_path)
    assert done.returncode == 1
    first, second, *_ = json.loads(done.stdout)["faults"]
    assert first.startswith("the plant refused ")
    assert "out of range: spool reference 3 is outside -1 to 1" in first
    assert second.startswith("the plant went to its safe state 1 time, first at 0.106 s: no valid command")
    if mode == "lockstep":
        assert read(tmp_path / "a.mcap").metadata["summary"]["commands"]["refused"] == {"out of range": 30}


def test_a_law_that_never_answers_is_named_in_lockstep(tmp_path: Path):
    (tmp_path / "mine.py").write_text("import time\n" + LAW.format("time.sleep(3.0); return 0.0, memory"))
    done = hydrotwin("run", "step", "--mode", "lockstep", "--patience", "1", *QUICK, *UNDRAWN, cwd=tmp_path)
    assert done.returncode == 1
    first = json.loads(done.stdout)["faults"][0]
    assert "the controller has not answered the measurement of tick 0 (t = 0 s) within 1 s" in first


@pytest.mark.parametrize("body", BAD_LAWS)
def test_a_recording_of_a_bad_run_tells_the_same(tmp_path: Path, body: str):
    (tmp_path / "mine.py").write_text(LAW.format(body))
    hydrotwin_here("run", "step", "--mode", "inprocess", *QUICK, "--json", "-", cwd=tmp_path)
    reason = BAD_LAWS[body].removeprefix("FAILED: ").removesuffix(" the first at")
    assert reason in problems(read(tmp_path / "a.mcap"))[0]


def test_a_scenario_that_provokes_refusals_says_so(tmp_path: Path):
    (tmp_path / "mine.py").write_text(LAW.format("return (3.0 if sample.stamp_ns == 50_000_000 else 0.0), memory"))
    run = ("run", "step", "--mode", "inprocess", *QUICK, "--json", "-")
    assert hydrotwin_here(*run, cwd=tmp_path).returncode == 1
    assert hydrotwin_here(*run, "--set", "allowed.refused=1", cwd=tmp_path).returncode == 0


def stopping(ticks: int) -> Iterator[list[Outgoing]]:
    """A controller that falls silent after so many ticks; the messages of each tick of the run."""
    plant, controller = sides(load("step", ["duration=0.3"]))
    speak = controller.answer
    controller.answer = lambda measurement: speak(measurement) if measurement.tick < ticks else []
    return exchange(plant, controller, 300)


def test_a_controller_that_stops_leads_to_the_safe_state_once_its_next_command_is_overdue():
    """It answers to 90 ms, acts at 95, is due at 105 and given 100 ms more."""
    events = [m.message for messages in stopping(100) for m in messages if m.topic == "event"]
    safe = [event for event in events if event.kind == "safe"]
    assert [event.applied_at for event in safe] == [205_000_000]


def test_a_controller_that_never_speaks_is_overdue_from_its_first_sample():
    """Due at 5 ms and given 100 ms; nothing is latched, since there is nobody who has lost the plant."""
    events = [m.message for messages in stopping(0) for m in messages if m.topic == "event"]
    (safe,) = [event for event in events if event.kind == "safe"]
    assert safe.applied_at == 105_000_000
    assert "first that was due" in safe.text


def faults(summary: Summary, *changes: str) -> list[str]:
    return verdict(summary, load("step", list(changes)))


def with_commands(**values) -> Summary:
    return GOOD._replace(commands=CommandSummary(**(GOOD.commands._asdict() | values)))  # pyright: ignore


def test_a_run_within_its_policy_is_good():
    """Two late commands in a hundred (2 %), 20 late ticks in a thousand, 20 ms at most."""
    assert not faults(GOOD)


BAD = {
    "the run ended early: interrupted": GOOD._replace(ending="interrupted after 20 ticks"),
    "of 100 commands 3 late (worst 1.50 ms): real_time.late_commands allows 0.02": with_commands(late=3),
    "of 100 commands 1 late (worst 1.50 ms) and 3 missing": with_commands(taken=97),
    "the plant refused 1 command (1 stale)": with_commands(refused={"stale": 1}, taken=99),
    "messages were lost on the way to the recorder: 2 timing": GOOD._replace(lost={"timing": 2}),
    "the plant went to its safe state 2 times": GOOD._replace(safe_states=2),
    "51 of 1000 ticks (5.10%) came": GOOD._replace(timing=TIMED._replace(overruns=OverrunTotals(3, 0.02, 9, 51))),
    "the worst by 120.0 ms": GOOD._replace(timing=TIMED._replace(overruns=OverrunTotals(1, 0.12, 9, 9))),
}


@pytest.mark.parametrize("words", BAD)
def test_each_kind_of_bad_run_has_its_one_line(words: str):
    (fault,) = faults(BAD[words])
    assert words in fault
    assert "\n" not in fault


def test_the_main_reason_comes_first():
    bad = GOOD._replace(ending="failed: the disk", safe_states=1, lost={"state": 1})
    found = faults(bad._replace(commands=with_commands(refused={"stale": 3, "latched": 9}).commands))
    beginnings = ("the run ended early", "the plant refused 3 ", "the plant went to its safe state", "messages were")
    assert [next(words for words in beginnings if fault.startswith(words)) for fault in found] == list(beginnings)


def test_what_follows_from_an_allowed_safe_state_is_allowed():
    """The silence before it, and the commands that its latch refuses."""
    bad = with_commands(taken=50, refused={"latched": 20})._replace(safe_states=1)
    assert len(faults(bad)) == 1
    assert not faults(bad, "allowed.safe_states=1")


def test_an_older_recording_is_judged_by_what_it_says():
    old = GOOD._replace(commands=CommandSummary(100, 0, 0.0, {}))
    assert not faults(old)
    assert faults(old._replace(timing=TIMED._replace(overruns=OverrunTotals(51, 0.02, 9))))


def test_a_scenario_that_expects_nothing_runs_and_is_not_checked(tmp_path: Path):
    """A check without a band would pass whatever happens."""
    (tmp_path / "own.toml").write_text('extends = "step"\nduration = "0.05 s"\nexpect = []\n')
    run = hydrotwin_here("run", "own.toml", "--mode", "inprocess", "--json", "-", cwd=tmp_path)
    check = hydrotwin_here("check", "own.toml", "--junit", "j.xml", cwd=tmp_path)
    assert (run.returncode, check.returncode) == (0, 1)
    assert "there is nothing to check" in check.stdout
    (failure,) = ET.parse(tmp_path / "j.xml").iter("failure")
    assert "states no band" in failure.attrib["message"]


@pytest.mark.parametrize(
    "own", ['name = "a\\u001b[31mb"\n', '[controller]\nkind = "python"\nlaw = "wrong:law"\n', "duration = 1 2\n"]
)
def test_a_check_that_is_refused_leaves_a_junit_file_in_error(tmp_path: Path, own: str):
    """Whatever lay there before: a control character in a name, a law that does not parse, a file that does not."""
    (tmp_path / "j.xml").write_text("<earlier/>")
    (tmp_path / "wrong.py").write_text("def law(sample) return 0.0\n")
    (tmp_path / "own.toml").write_text(f'extends = "step"\n{own}')
    done = hydrotwin_here("check", "own.toml", "--junit", "j.xml", cwd=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    (error,) = ET.parse(tmp_path / "j.xml").iter("error")
    assert "own.toml" in error.attrib["message"] or "wrong.py, line 1" in error.attrib["message"]


def test_a_law_that_fails_fails_its_check_alone(tmp_path: Path):
    """With its line, in table and JUnit file; what else is checked is judged all the same."""
    (tmp_path / "mine.py").write_text(LAW.format("return 1 / 0, memory"))
    band = 'extends = "step"\nduration = "0.05 s"\nexpect = ["overshoot <= 500 %"]\n'
    (tmp_path / "own.toml").write_text(band + '[controller]\nkind = "python"\nlaw = "mine:law"\n')
    (tmp_path / "good.toml").write_text('extends = "step"\nduration = "0.05 s"\nexpect = ["max error <= 1 m"]\n')
    done = hydrotwin_here("check", "own.toml", "good.toml", "--junit", "j.xml", cwd=tmp_path)
    assert done.returncode == 1
    suites = {suite.attrib["name"]: suite for suite in ET.parse(tmp_path / "j.xml").iter("testsuite")}
    assert [suites[name].attrib["failures"] for name in ("own", "good")] == ["2", "0"]
    assert any("mine.py, line 2: ZeroDivisionError" in f.attrib["message"] for f in suites["own"].iter("failure"))


def test_a_run_that_ended_early_passes_no_band(tmp_path: Path):
    """Each would pass: 0.3 s of standing still say nothing about the rest."""
    words = ["expect=['max error <= 61 mm', 'peak p_lower <= 80 bar', 'mean velocity from 0.1 s to 0.2 s <= 1 m/s']"]
    scenario, ticks = load("step", [*words, "duration=2"]), iter(range(10_000))
    recorded = record_in_process(scenario, tmp_path / "a.mcap", stopped=lambda: next(ticks) >= 300)
    early = load_run(recorded.path)
    assert [verdict.passed for verdict in early.verdicts] == [False] * 3
    assert all(verdict.found.endswith(", until it ended early") for verdict in early.verdicts)
    whole = load_run(record_in_process(load("step", [*words, "duration=0.3"]), tmp_path / "b.mcap").path)
    assert [verdict.passed for verdict in whole.verdicts] == [True] * 3


REQUIREMENTS = """\
extends = "step"
name = "own"
duration = 3.0
expect = [
    {id = "HYD-012", text = "Never more than 80 bar.", band = "peak p_lower <= 80 bar"},
    {id = "HYD-007", band = "overshoot <= 0.1 %"},
    "limit cycle amplitude <= 0.4 mm",
]
"""


def test_a_requirement_is_named_with_what_was_found(tmp_path: Path):
    (tmp_path / "own.toml").write_text(REQUIREMENTS)
    done = hydrotwin_here("check", "own.toml", "--junit", "j.xml", cwd=tmp_path)
    assert done.returncode == 1
    assert "HYD-007: overshoot <= 0.1 %" in done.stdout
    suite = ET.parse(tmp_path / "j.xml").getroot()[0]
    cases = {case.get("name"): case for case in suite}
    held = {p.get("name"): p.get("value") for p in cases["HYD-012: peak p_lower <= 80 bar"].iter("property")}
    assert held["requirement"] == "HYD-012"
    assert held["requirement text"] == "Never more than 80 bar."
    assert str(held["found"]).endswith(" bar")
    assert [name for name, case in cases.items() if case.find("failure") is not None] == ["HYD-007: overshoot <= 0.1 %"]
    assert suite.get("time") == cases["run"].get("time") != "0.000"


def test_coverage_lists_requirements_and_runs_nothing(tmp_path: Path):
    (tmp_path / "own.toml").write_text(REQUIREMENTS)
    done = hydrotwin_here("check", "own.toml", "step", "--coverage", "--json", cwd=tmp_path)
    rows = [(row["requirement"], row["scenario"]) for row in json.loads(done.stdout)]
    assert rows[:3] == [("HYD-007", "own"), ("HYD-012", "own"), ("", "own")]
    assert {scenario for _, scenario in rows[3:]} == {"step"}
    assert [path.name for path in tmp_path.iterdir()] == ["own.toml"]


@pytest.mark.parametrize(
    ("expected", "complaint"),
    [
        ('{id = "a b", band = "overshoot <= 5 %"}', "expect.0.requirement.id: 'a b' has other characters"),
        ('{band = "overshoot <= 5 %"}', "expect.0.requirement.id: missing; write it"),
        ('{id = "a", band = "overshot <= 5 %"}', "no metric 'overshot'; did you mean 'overshoot'"),
    ],
)
def test_a_requirement_that_is_none_is_one_line(expected: str, complaint: str, tmp_path: Path):
    (tmp_path / "own.toml").write_text(f'extends = "step"\nexpect = [{expected}]\n')
    done = hydrotwin_here("check", "own.toml", cwd=tmp_path)
    assert done.returncode == 2
    assert complaint in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_check_overwrites_nothing_and_a_bad_scenario_stops_no_other(tmp_path: Path):
    """Two calls into one folder, with a page on each run; what could not be run is an error in the JUnit file."""
    (tmp_path / "good.toml").write_text('extends = "step"\nduration = "0.05 s"\nexpect = ["max error <= 1 m"]\n')
    (tmp_path / "bad.toml").write_text('extends = "step"\nduration = "0.05 s"\n[rig.load]\nmas = 3\n')
    words = ("check", "bad.toml", "good.toml", "-o", "m", "--junit", "j.xml")
    done = hydrotwin_here(*words, "--report", cwd=tmp_path)
    assert done.returncode == 2  # the others' verdicts are in the JUnit file
    assert "rig.load.mas: unknown key; did you mean 'mass'" in done.stdout
    suites = {suite.attrib["name"]: suite for suite in ET.parse(tmp_path / "j.xml").iter("testsuite")}
    assert (suites["bad.toml"].get("errors"), suites["good"].get("failures")) == ("1", "0")
    first = (tmp_path / "m" / "good.mcap").read_bytes()
    assert hydrotwin_here("check", "good.toml", "-o", "m", cwd=tmp_path).returncode == 0
    assert (tmp_path / "m" / "good.mcap").read_bytes() == first
    assert sorted(path.name for path in (tmp_path / "m").iterdir()) == ["good-2.mcap", "good.html", "good.mcap"]
