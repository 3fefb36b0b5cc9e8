"""PID on the twin, and laws that are told when their commands do not act: in process, in lockstep, and replayed."""

from pathlib import Path

import numpy as np
import pytest

from bridge.errors import RunError
from bridge.recording.reader import read
from bridge.replay.through import Through, replay_through
from bridge.runs.in_process import record_in_process
from bridge.scenario import Scenario, ScenarioError, load
from bridge.scenario.gains import law_gains
from bridge.studies.stability.trial import stand, trial
from controller.law import per_metre
from controller.pid import PidGains
from controller.reference import evaluate

WIDE = ["duration=6", "start.position=0.05", "reference.start=0.05", "reference.end=0.22"]
PID = ["controller.kind=pid", "controller.integral='1 V/(% s)'"]
TELLING = """
def law(sample, target, memory, gains):
    count = (memory or 0) + 1
    broken = 100_000_000 <= sample.stamp_ns < 400_000_000
    return (2.0 if broken else count * 1e-3), count

def on_safe_state(memory):
    return 10

def on_resume(memory):
    return memory + 20
"""
SHORT = ["duration=0.8", "loop.command_timeout=0.1", "loop.after_timeout=resume"]


def rms(scenario: Scenario) -> float:
    """Of the true position's error [m]."""
    found = trial(scenario, stand(scenario))
    reference = scenario.reference.reference()
    return float(np.sqrt(np.mean([(evaluate(reference, t).position - x) ** 2 for t, x, _ in zip(*found, strict=True)])))


def test_the_pid_scenario_follows_closer_than_a_pd_of_its_gain():
    pid = load("pid")
    pd = load("pid", ["controller.kind=pd", "controller.derivative=0"])
    assert rms(pid) < 0.3 * rms(pd)


def test_anti_windup_takes_the_overshoot_on_the_twin():
    """170 mm are half a second at the valve's end."""
    on = stand(load("step", WIDE))
    none, back, clamped = (
        trial(load("step", [*WIDE, *PID, f"controller.anti_windup={kind}"]), on).position.max() - 0.22
        for kind in ("none", "back-calculation", "clamping")
    )
    assert back < 0.6 * none
    assert clamped < 0.3 * none


def test_gains_of_pid_in_si():
    """A V/(% s) is 1/27 of 1 mm s of the 270 mm and 10 V; unset, the integral is led within P/K."""
    found = law_gains(load("step", [*PID, "controller.gain=0.5", "controller.feed_forward='2 s/m'"]))
    assert isinstance(found, PidGains)
    assert found.integral == pytest.approx(per_metre(1.0, 0.27, 10.0))
    assert (found.feed_forward, found.anti_windup) == (2.0, "back-calculation")
    assert found.tracking_time == pytest.approx(0.5)
    faster = law_gains(load("step", [*PID, "controller.tracking_time='50 ms'"]))
    assert isinstance(faster, PidGains)
    assert faster.tracking_time == 0.05


def test_a_tracking_time_shorter_than_the_sample_period_is_refused():
    with pytest.raises(ScenarioError, match=r"tracking_time 0\.002 s must be at least loop\.sample_period, 0\.01 s"):
        load("step", [*PID, "controller.tracking_time='2 ms'"])


def told(folder: Path, text: str = TELLING, changes: tuple[str, ...] = ()) -> Scenario:
    (folder / "telling.py").write_text(text)
    return load("step", [*SHORT, f"controller.law={folder}/telling.py:law", *changes])


def spools(path: Path) -> dict[int, float]:
    """Commands by the time of their sample [ms]."""
    columns = read(path).columns("command")
    return dict(zip((columns["sample_stamp"] // 1_000_000).tolist(), columns["spool"].tolist(), strict=True))


def test_a_law_is_told_of_the_safe_state_and_of_the_resume(tmp_path: Path):
    """Refused from 100 to 390 ms, the law is told 10 when the valve is centred, and 20 more when it is taken again."""
    record_in_process(told(tmp_path), tmp_path / "a.mcap")
    found = spools(tmp_path / "a.mcap")
    kinds = {event.kind: event.stamp for event in read(tmp_path / "a.mcap").messages("event")}
    assert {"safe", "resumed"} <= set(kinds)
    samples = (400_000_000 - kinds["safe"]) // 10_000_000  # counted after the safe state, until a command is good again
    assert found[90] == pytest.approx(10e-3)
    assert found[400] == pytest.approx((10 + samples + 1) * 1e-3, abs=1.1e-3)
    assert found[420] - found[400] == pytest.approx(22e-3)


def test_without_hooks_the_memory_starts_anew(tmp_path: Path):
    without = TELLING[: TELLING.index("def on_safe_state")]
    record_in_process(told(tmp_path, without), tmp_path / "a.mcap")
    found = spools(tmp_path / "a.mcap")
    assert found[420] == pytest.approx(2e-3, abs=1.1e-3)


def test_a_hook_that_fails_is_one_line(tmp_path: Path):
    with pytest.raises(RunError, match=r"on_resume: .*telling\.py, line 11: AttributeError"):
        record_in_process(told(tmp_path, TELLING.replace("memory + 20", "memory.nothing")), tmp_path / "a.mcap")


@pytest.mark.parametrize("alone", [True, False])
def test_a_replay_tells_the_law_at_the_same_samples(tmp_path: Path, alone: bool):
    """In this process, and in a controller process that hears the plant's events on the bus."""
    record_in_process(told(tmp_path), tmp_path / "a.mcap")
    assert replay_through(tmp_path / "a.mcap", Through("controller", tmp_path / "b.mcap", alone=alone)).passed
    assert spools(tmp_path / "b.mcap") == spools(tmp_path / "a.mcap")
