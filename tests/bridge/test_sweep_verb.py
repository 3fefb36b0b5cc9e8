"""`hydrotwin sweep`: every combination, judged as single runs are; interrupted, resumed and shared, the same bytes."""

import csv
import json
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import hydrotwin as ht
from bridge.recording.digest import digest
from bridge.runs.in_process import record_in_process
from bridge.runs.measures import values_of
from bridge.runs.sweep.axes import axes_of, combinations
from bridge.runs.sweep.sweep import Wanted
from bridge.runs.sweep.theory import theory_edge
from bridge.scenario import load
from bridge.scenario.measures import measures_of
from bridge.studies.stability.chart import OfRig, chart
from bridge.studies.sweep.journal import Journal
from tests.support.command import hydrotwin_here
from tests.support.processes import ENVIRONMENT, ROOT

PAGE = (ROOT / "docs/sweeps.md").read_text(encoding="utf-8")
SHORT = ("--set", "duration=0.2", "--set", "reference.at=50 ms", "--workers", "1")
METRICS = "rms error, peak p_lower, mean p1 from 100 ms to end"


def table(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(line for line in path.read_text().splitlines() if not line.startswith("#")))


def test_the_sweep_of_the_page_marks_the_best_gain(tmp_path: Path):
    """Its eight gains: the marked ones are the smallest of the CSV, in the order of the axis."""
    command = next(line for line in PAGE.splitlines() if line.startswith("    hydrotwin sweep step controller.gain="))
    words = shlex.split(command)[1:]
    done = hydrotwin_here(*words, *("--set", "duration=1 s", "--set", "reference.at=0.2 s"), "-o", "s", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = table(tmp_path / "s/sweep.csv")
    gains = [float(row["controller.gain [V/%]"]) for row in rows]
    assert gains == np.linspace(0.5, 4.0, 8).tolist()
    assert done.stdout.count(" *") == 3
    for column in ("rms error [mm]", "overshoot [%]", "peak p_lower [bar]"):
        best = min(rows, key=lambda row: float(row[column]))
        assert f"{float(best[column]):.4g} *" in done.stdout
    assert (tmp_path / "s/sweep.png").read_bytes()[:4] == b"\x89PNG"
    assert "critical gain by linear theory" in done.stdout


def test_a_row_is_what_a_single_run_says(tmp_path: Path):
    """Recorded on disk at the same gain and delay, with the metrics of that file; a kept recording is that one."""
    words = ("controller.gain=1,2", "loop.delay=0 ms,10 ms", "-m", METRICS, "--judge", "--keep")
    done = hydrotwin_here("sweep", "step", *words, *SHORT, "-o", "s", "--json", cwd=tmp_path)
    found = json.loads(done.stdout)
    row = found["rows"][3]
    assert row["set"] == {"controller.gain": "2", "loop.delay": "10 ms"}
    changes = ["controller.gain=2", "loop.delay=10 ms", "duration=0.2", "reference.at=50 ms"]
    scenario = load("step", changes)
    alone = record_in_process(scenario, tmp_path / "alone.mcap")
    assert digest(tmp_path / "s/recordings/00004.mcap") == digest(alone.path)
    run = ht.read(alone.path)
    expected = values_of(measures_of([METRICS]), scenario, run.summary, run.recording)
    assert list(row["values"].values()) == expected
    assert expected[0] == run.metrics.rms_error
    assert row["passed"] == run.passed
    assert row["failed"] == [band.text for band in run.bands if not band.passed]
    assert table(tmp_path / "s/sweep.csv")[3]["recording"] == "recordings/00004.mcap"


def test_the_table_states_units_and_the_numbers_that_all_runs_share(tmp_path: Path):
    hydrotwin_here("sweep", "assumed-rig", "loop.delay=500 us,10 ms", *SHORT, "-o", "s", cwd=tmp_path)
    text = (tmp_path / "s/sweep.csv").read_text()
    assert "loop.delay [ms],rms error [mm],reason\n0.5," in text
    for line in ("# duration = 0.2 s", "# controller.gain = 1.0 V/%", "# rig.pipe_2.length = 2.5 m", "# seed = 1"):
        assert f"{line}\n" in text
    assert "# loop.delay" not in text


def test_a_run_that_fails_has_a_reason_and_stops_nobody(tmp_path: Path):
    (tmp_path / "mine.py").write_text(
        "def law(sample, target, memory, gains):\n"
        "    k = gains.parameters.k\n"
        "    return 1.0 / (k - 2) if k < 3 else float('nan'), memory\n"
    )
    words = ("sweep", "step", "controller.parameters.k=1,2,3", "--set", "controller.law=mine.py:law", *SHORT)
    done = hydrotwin_here(*words, "-o", "s", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    good, failing, refused = table(tmp_path / "s/sweep.csv")
    assert (good["reason"], failing["rms error [mm]"], refused["rms error [mm]"]) == ("", "", "")
    assert "mine.py, line 3: ZeroDivisionError" in failing["reason"]
    assert "not finite" in refused["reason"]
    assert "2 of 3 runs failed" in done.stdout


def test_a_combination_that_cannot_be_has_a_reason(tmp_path: Path):
    """101 ms are a whole number of measurements that come every 1 ms, not of those that come every 2 ms."""
    axes = ("duration=100 ms,101 ms", "loop.daq_period=1 ms,2 ms")
    done = hydrotwin_here("sweep", "step", *axes, *SHORT[2:], "-o", "s", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    reasons = [row["reason"] for row in table(tmp_path / "s/sweep.csv")]
    assert [bool(reason) for reason in reasons] == [False, False, False, True]
    assert "not a whole number of DAQ periods" in reasons[3]


def test_interrupted_resumed_and_shared_sweeps_write_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    words = ("sweep", "step", "controller.gain=1:4:4", "-m", METRICS, *SHORT[:-2])
    assert hydrotwin_here(*words, "--workers", "1", "-o", "one", cwd=tmp_path).returncode == 0
    assert hydrotwin_here(*words, "--workers", "2", "-o", "two", cwd=tmp_path).returncode == 0
    add = Journal.add

    def stop(self, point, result):
        add(self, point, result)
        if len(self.found) == 2:
            raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(Journal, "add", stop)
        assert hydrotwin_here(*words, "--workers", "1", "-o", "cut", cwd=tmp_path).returncode == 130
    assert len((tmp_path / "cut/sweep.part").read_text().splitlines()) == 3
    assert hydrotwin_here(*words, "--workers", "1", "-o", "cut", cwd=tmp_path).returncode == 0
    files = [{path.name: path.read_bytes() for path in (tmp_path / name).iterdir()} for name in ("one", "two", "cut")]
    assert sorted(files[0]) == ["sweep.csv", "sweep.png"]
    assert files[0] == files[1] == files[2]


def test_ctrl_c_ends_it_within_a_second_and_says_how_to_continue(tmp_path: Path):
    words = ["sweep", "step", "controller.gain=1:4:400", "--set", "duration=0.1", "--workers", "1"]
    command = [sys.executable, "-m", "bridge", *words]
    with subprocess.Popen(command, cwd=tmp_path, env=ENVIRONMENT, stderr=subprocess.PIPE, text=True) as process:
        end = time.monotonic() + 60.0
        while not (parts := list(tmp_path.glob("runs/*/sweep.part"))) or parts[0].read_bytes().count(b"\n") < 3:
            assert process.poll() is None
            assert time.monotonic() < end
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        begun = time.monotonic()
        said = process.communicate(timeout=30.0)[1]
    assert time.monotonic() - begun < 1.0
    assert process.returncode == -signal.SIGINT
    folder = parts[0].parent.relative_to(tmp_path)
    again = re.search(r"hydrotwin: interrupted; \d+ runs kept in (\S+); to continue: hydrotwin (.*)\n", said)
    assert again is not None, said
    assert again[1] == str(folder / "sweep.part")
    assert shlex.split(again[2]) == [*words, "-o", str(folder)]


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        ("controller.gian=1:2:3", "controller.gian=1: unknown key; did you mean 'gain'"),
        ("gain=1,2", "gain=1: does not belong here; write it under [controller]"),
        ("controller.gain=1:2", "write FROM:TO:COUNT"),
        ("controller.gain=-1:1:3:log", "even ratios"),
        ("controller.gain=2", "one value is not an axis"),
        ("controller.gain=1:2:1", "one value is not an axis"),
        ("controller.gain=1,2,1.0", "stands twice"),
        ("controller.gain=1,,2", "a value is missing"),
        ("'controller.gain=1 V/%,20 1/m'", "write all values in one unit"),
        ("controller.gain=1,2 controller.gain=3,4", "named twice"),
        ("controller.gain=1,2 --set controller.gain=3", "controller.gain is varied"),
        ("controller.gain", "write NAME=VALUES"),
        ("loop.delay=0:10:3", "10 has no unit, and would be 10 s"),
        ("'loop.delay=0:10 ms:8'", "nearest: 0.0014 or 0.00145 s"),
        ("'loop.delay=1 bar,2 bar'", "unit 'bar' does not fit here"),
        ("controller.limit=0.5,1.5", "controller.limit=1.5: 1.5 must be at most 1.0"),
        ("controller.gain=1:2:300 'loop.delay=0:1 s:1000'", "300000 runs are more than 100000"),
        ("controller.gain=1,2 -m 'overshot'", "did you mean 'overshoot'"),
        ("controller.gain=1,2 -m 'mean p_1'", "no signal 'p_1'"),
        ("controller.gain=1,2 -m 'overshoot, overshoot'", "named twice"),
        ("controller.gain=1,2 -m 'rms error from 3 s to 30 s'", "lengthen duration or move the window"),
        ("controller.gain=1,2 --judge --set 'expect=[]'", "states no band"),
        ("rig.cylinder.stroke=0.2,0.3", "0.2 has no unit"),
    ],
)
def test_a_mistake_gets_one_line_before_anything_runs(words: str, answer: str, tmp_path: Path):
    done = hydrotwin_here("sweep", "step", *shlex.split(words), cwd=tmp_path)
    assert done.returncode == 2
    assert answer in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_values_are_even_in_steps_or_in_ratios():
    scenario = load("step")
    steps, ratios = axes_of(["loop.delay=0:10 ms:3", "controller.gain=0.1:10:3:log"], scenario)
    assert steps.texts == ("0 ms", "5 ms", "10 ms")
    assert steps.si == [0.0, 0.005, 0.01]
    assert ratios.numbers == (0.1, 1.0, 10.0)
    assert combinations([steps, ratios])[:4] == [(0, 0), (0, 1), (0, 2), (1, 0)]
    mixed = axes_of(["loop.delay=500 us,10 ms", "controller.velocity=measured,backward"], scenario)
    assert [axis.numbers for axis in mixed] == [(0.5, 10.0), None]


def test_the_edge_beside_the_runs_is_where_the_map_changes_colour():
    scenario = load("step")
    axes = axes_of(["controller.gain=1,9", "loop.delay=5 ms,30 ms"], scenario)
    edge = theory_edge(Wanted(scenario, axes, measures_of(["overshoot"])))
    assert edge is not None
    family = OfRig(scenario)
    for delay, gain in zip(edge.places, edge.gains, strict=True):
        family.numbers["delay"] = delay
        found = chart(family, "derivative", "gain", np.zeros(1), gain * np.array([0.999, 1.001]))
        assert [bool(outside) for outside in found.outside[:, 0]] == [False, True]
    assert theory_edge(Wanted(scenario, axes[1:], measures_of(["overshoot"]))) is None


def test_a_sweep_from_python_has_columns_in_si():
    axes = {"loop.delay": [0.0, "10 ms"], "controller.gain": "1:2:2"}
    found = ht.sweep("step", axes, ["rms error", "rise time"], {"duration": 0.2, "reference.at": 0.05}, judge=True)
    columns = found.columns
    assert columns["loop.delay"].tolist() == [0.0, 0.0, 0.01, 0.01]
    assert columns["controller.gain"].tolist() == [1.0, 2.0, 1.0, 2.0]
    alone = ht.run("step", changes={"duration": 0.2, "reference.at": 0.05, "loop.delay": 0.01, "controller.gain": 2})
    assert columns["rms error"][3] == alone.metrics.rms_error
    assert found.units == {"loop.delay": "s", "controller.gain": "V/%", "rms error": "m", "rise time": "s"}
    assert found.best("rms error")["rms error"] == columns["rms error"].min()
    with pytest.raises(ht.UsageError, match="no run has a 'rise time'"):
        found.best("rise time")
