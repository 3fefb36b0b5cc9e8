"""The package `hydrotwin`: what its page says, runs in memory that are those on disk, and what tests say of signals."""

import math
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import hydrotwin as ht
from bridge.recording.digest import digest
from bridge.recording.words import sentence
from bridge.runs.in_process import record_in_process
from hydrotwin.signal import Signal
from tests.support.processes import ENVIRONMENT, ROOT

PAGE = (ROOT / "docs/python.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
READ: dict[str, Any] = {"capture_output": True, "text": True, "timeout": 100}


@pytest.fixture
def ramp() -> Signal:
    """0 to 10 bar in 10 s."""
    return Signal("p", "Pa", np.arange(11.0), 1e5 * np.arange(11.0))


def test_the_page_runs_as_it_stands(capsys: pytest.CaptureFixture[str]):
    place: dict[str, object] = {}
    exec(BLOCKS[0], place)
    exec(BLOCKS[1], place)
    exec(BLOCKS[2], place)
    printed = capsys.readouterr().out
    assert "overshoot <= 5 %" in printed
    assert "Pa 3.0" in printed
    assert "'loop.delay': 0.0" in printed


def test_a_run_in_memory_is_that_on_disk(tmp_path: Path):
    run = ht.run("step", changes={"duration": 0.3})
    saved = run.save(tmp_path / "saved.mcap")
    recorded = record_in_process(ht.load("step", ["duration=0.3"]), tmp_path / "recorded.mcap")
    assert digest(saved) == digest(recorded.path)
    again = ht.read(saved)
    assert again.summary == run.summary
    assert [band.found for band in again.bands] == [band.found for band in run.bands]


def test_changes_may_be_nested_and_of_any_kind():
    changes = {"loop": {"delay": "20 ms"}, "controller.gain": "2 V/%", "daq.quantise": False, "duration": 2}
    scenario = ht.load("step", {**changes, "expect": ["max error <= 61 mm"]})
    assert (scenario.loop.delay, scenario.daq.quantise, scenario.duration) == (0.02, False, 2.0)
    assert scenario.expect == ["max error <= 61 mm"]
    with pytest.raises(ht.UsageError, match="changes go with the name"):
        ht.run(scenario, changes={"duration": 3})


def test_a_law_that_fails_is_named_with_its_line():
    def law(sample, target, memory, gains):
        return 1 / 0, memory

    with pytest.raises(ht.RunError, match=r"test_python_interface\.py, line \d+: ZeroDivisionError"):
        ht.run("step", law)
    with pytest.raises(ht.ScenarioError, match="is not a law"):
        ht.run("step", "mine.py:law")  # pyright: ignore[reportArgumentType]


def test_a_bad_run_is_not_passed():
    run = ht.run("step", lambda *_: (3.0, None), changes={"duration": 0.2, "expect": ["max error <= 61 mm"]})
    assert not run.passed
    assert "out of range" in run.faults[0]


def test_an_unknown_signal_is_refused_with_the_nearest():
    run = ht.run("step", changes={"duration": 0.01})
    with pytest.raises(ht.UsageError, match="did you mean 'p_lower'"):
        run.signal("p_lowre")
    assert run.signal("p2").name == "p2"


def test_a_frame_has_a_column_of_times_for_every_topic(monkeypatch: pytest.MonkeyPatch):
    """pandas is not needed for the tests: what it would be given is looked at."""
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=dict))
    run = ht.run("step", changes={"duration": 0.05})
    for topic in ("state", "measurement", "command"):
        time = run.frame(topic)["time"]
        assert len(time) == len(run.columns(topic)["sequence"])
        assert 0.0 <= time[0] < time[-1] <= 0.05
    with pytest.raises(ht.UsageError, match="frames are of 'pandas' or 'polars'"):
        run.frame(library="numpy")  # pyright: ignore[reportArgumentType]
    monkeypatch.setitem(sys.modules, "polars", None)
    with pytest.raises(ht.UsageError, match="pip install polars"):
        run.frame(library="polars")


def test_the_recording_names_a_law_that_no_file_holds(tmp_path: Path):
    def push(sample, target, memory, gains):
        return 0.3, memory

    saved = ht.run("step", push, changes={"duration": 0.05}).save(tmp_path / "a.mcap")
    law = ht.read(saved).recording.metadata["run"]["law"]
    assert law["name"].endswith("push")
    assert "return 0.3, memory" in law["text"]


def test_topics_of_others_are_not_written_again(tmp_path: Path):
    run = ht.run("step", changes={"duration": 0.02})
    run.recording.entries.add("camera", 0, 0, b"")
    with pytest.raises(ht.UsageError, match="topics that are not ours \\(camera\\): copy the file"):
        run.save(tmp_path / "a.mcap")


def test_what_a_signal_does_is_told_with_value_and_time(ramp: Signal):
    assert ramp.stays(below="10 bar", above=0.0) is ramp
    with pytest.raises(AssertionError, match=r"p does not stay below 8 bar: it is 9 bar at 9 s"):
        ramp.stays(below="8 bar", before="9 s")
    with pytest.raises(AssertionError, match=r"p does not stay above 3 bar: it is 2 bar at 2 s"):
        ramp.stays(above="3 bar", after=2.0)
    assert ramp.reaches(above="4.5 bar") == 5.0
    assert ramp.reaches(below="9 bar", after="3 s") == 3.0
    with pytest.raises(AssertionError, match="p is never above 11 bar; it comes to 10 bar"):
        ramp.reaches(above="11 bar")
    assert ramp.settles(at="9 bar", within="1 bar") == 8.0
    with pytest.raises(AssertionError, match=r"within 1 bar before 7 s: it is 7 bar at 7 s, 2 bar away"):
        ramp.settles(at="9 bar", within="1 bar", before="7 s")
    with pytest.raises(AssertionError, match="it is 10 bar at 10 s"):
        ramp.settles(at="0 bar", within="1 bar")
    with pytest.raises(ValueError, match="nothing from 11 s"):
        ramp.part(after="11 s")


def test_a_hole_in_a_signal_is_not_within_any_limit(ramp: Signal):
    ramp.value[3] = math.nan
    with pytest.raises(AssertionError, match="at 3 s"):
        ramp.stays(below="1 MPa")
    assert ramp.settles(at="5 bar", within="9 bar") == 4.0


def test_the_steps_for_a_ci_service_run_and_keep_what_has_failed(tmp_path: Path):
    """Those of the page, but for the installation, in a shell; with two further tests, which fail."""
    (tmp_path / "my_laws.py").write_text(BLOCKS[0].split("run = ")[0])
    tests = BLOCKS[3] + "\n\ndef test_that_fails(rig):\n    rig.signal('p2').stays(below='1 bar')\n"
    tests += "import pytest\n@pytest.mark.parametrize('p', ['a/b'])\ndef test_with(rig, p):\n    assert not rig.run()\n"
    (tmp_path / "test_laws.py").write_text(tests)
    steps = [step for step in re.findall(r"- run: (.*)", PAGE) if "pip install" not in step]
    path = f"{Path(sys.executable).parent}:{ENVIRONMENT['PATH']}"
    own = {"PATH": path, "PYTEST_ADDOPTS": "-p hydrotwin.pytest_plugin -p no:cacheprovider"}
    run = [subprocess.run(["sh", "-c", s], cwd=tmp_path, env=ENVIRONMENT | own, **READ) for s in steps]
    assert [done.returncode for done in run] == [0, 1], [done.stdout + done.stderr for done in run]
    assert {(tmp_path / name).is_file() for name in ("checks.xml", "tests.xml")} == {True}
    done = run[1]
    assert "2 failed, 1 passed" in done.stdout
    assert "p2 does not stay below 1 bar: it is" in done.stdout
    kept = sorted(path.name for path in (tmp_path / "failed").iterdir())
    assert kept == ["test_that_fails.mcap", "test_with[a_b].mcap"]
    assert ht.read(tmp_path / "failed" / "test_that_fails.mcap").summary.ending.startswith("complete")


def test_the_words_of_a_run_name_the_law_that_a_program_hands_over():
    """It is no part of the scenario, which has another."""

    def law(sample: Any, target: Any, memory: Any, gains: Any) -> tuple[float, Any]:
        return 0.0, memory

    said = sentence(ht.run("step", law, changes={"duration": 0.2}).recording)
    assert f"under the law {law.__qualname__}" in said
    assert "under the law pd" in sentence(ht.run("step", changes={"duration": 0.2}).recording)
