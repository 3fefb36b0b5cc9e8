"""The controller `state-space`: what it commands, and what does not fit is refused in one line."""

from pathlib import Path
from typing import Any

import pytest

from bridge.errors import ScenarioError
from bridge.loop.law import law_of
from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process
from bridge.scenario import Scenario, check, load
from bridge.scenario.gains import law_gains
from controller.law import Sample
from controller.reference import Target

PERIOD = load("step").loop.sample_period
LAG: dict[str, Any] = {
    "kind": "state-space",
    "A": [[0.5, 0.1], [0.0, 0.25]],
    "B": [[1.0, 0.0], [2.0, -1.0]],
    "C": [[0.5, 2.0]],
    "D": [[4.0, -0.5]],
    "dt": PERIOD,
    "inputs": ["error", "velocity"],
}


def scenario(**changes: Any) -> Scenario:
    data = {"reference": {"kind": "constant", "value": 0.1}, "loop": {"sample_period": PERIOD}}
    return check(data | {"daq": {"tachometer": True}, "controller": LAG | changes}, "own")


def commands(rig: Scenario, inputs: list[tuple[float, float]]) -> list[float]:
    """At x = 0.1 m - error, with the tachometer's velocity."""
    law, gains, memory, found = law_of(rig.controller), law_gains(rig), None, []
    for error, v in inputs:
        spool, memory, *_ = law.answer(Sample(0, 0.1 - error, v, 0.0, 0.0, 0.0), Target(0.1, 0.0), memory, gains)
        found.append(spool)
    return found


def test_commands_are_those_of_scipy():
    """scipy.signal.dlsim integrates the same matrices."""
    signal = pytest.importorskip("scipy.signal")
    inputs = [(0.01, 0.0), (0.02, 0.1), (-0.01, 0.05), (0.0, -0.1), (0.003, 0.0)]
    wanted = signal.dlsim((LAG["A"], LAG["B"], LAG["C"], LAG["D"], PERIOD), inputs)[1][:, 0]
    assert commands(scenario(), inputs) == pytest.approx(list(wanted), abs=1e-14)
    assert max(abs(commands(scenario(limit=0.05), inputs)[k]) for k in range(5)) == 0.05


def test_the_memory_is_forgotten_at_safe_state_and_on_resume():
    law = law_of(scenario().controller)
    assert law.on_safe_state([1.0, 2.0]) is None
    assert law.on_resume([1.0, 2.0]) is None


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"A": [[0.5, 0.1]]}, "A is 1 x 2, expected 1 x 1: A is square"),
        ({"B": [[1.0], [2.0]]}, "B is 2 x 1, expected 2 x 2: A has 2 rows, there are 2 inputs"),
        ({"C": [[0.5, 2.0], [1.0, 1.0]]}, "C is 2 x 2, expected 1 x 2: one output, 2 states, 2 inputs"),
        ({"A": [], "B": [], "C": []}, "C is 0 x 0, expected 1 x 0"),
        ({"D": [[4.0]]}, "D is 1 x 1, expected 1 x 2"),
        ({"A": [[0.5, 0.1], [0.0]]}, "A is ragged, expected 2 x 2"),
        ({"D": [[4.0, float("nan")]]}, "finite"),
        ({"dt": 2 * PERIOD}, f"controller.dt {2 * PERIOD:g} s must equal loop.sample_period, {PERIOD:g} s"),
        ({"inputs": ["error", "p4"]}, "p4"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(changes: dict[str, Any], said: str):
    with pytest.raises(ScenarioError) as error:
        scenario(**changes)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_velocity_needs_a_tachometer():
    with pytest.raises(ScenarioError, match=r"controller\.inputs 'velocity' needs a tachometer"):
        check(scenario().model_dump() | {"daq": {"tachometer": False}}, "own")


def test_in_a_whole_run_a_gain_alone_is_the_proportional_controller(tmp_path: Path):
    """Exactly: D e is the same product as P e, and there is neither a state nor a derivative."""
    short = ["duration=0.2 s", "controller.compensate_overlap=true"]
    plain = ["controller.kind=pd", "controller.gain=5 1/m", "controller.derivative=0 s/m"]
    own = ["controller.kind=state-space", "controller.D=[[5.0]]", f"controller.dt={PERIOD}"]
    spools = []
    for name, changes in (("pd", plain), ("own", own)):
        record_in_process(load("step", short + changes), tmp_path / f"{name}.mcap")
        spools.append(read(tmp_path / f"{name}.mcap").columns("command")["spool"].tolist())
    assert spools[0] == spools[1]
    assert max(map(abs, spools[0])) > 0.1
