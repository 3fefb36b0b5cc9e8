"""The controllers of a scenario: each kind has its own parameters, and what it does not have is refused by name."""

from pathlib import Path
from typing import Any

import pytest

from bridge.errors import ScenarioError
from bridge.recording.earlier import in_todays_words
from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process
from bridge.scenario import check, load
from bridge.scenario.controllers import KINDS, Python
from bridge.scenario.gains import law_gains
from controller.law import Gains, OpenLoopGains, RelayGains, per_metre

OWN = {
    "python": {"law": "mine:law"},
    "state-space": {"D": [[5.0]], "dt": 0.01},
    "c": {"source": "law.c"},
    "fmu": {"fmu": "law.fmu"},
}
GOLDEN = Path(__file__).parents[2] / "recordings" / "step.mcap"


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_knows_its_own_parameters(kind: str):
    data = {"reference": {"kind": "constant", "value": 0.1}, "controller": {"kind": kind, **OWN.get(kind, {})}}
    assert check(data, "own").controller.kind == kind
    with pytest.raises(ScenarioError, match=r"controller\.integrity: unknown key"):
        check(data | {"controller": data["controller"] | {"integrity": 1}}, "own")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (["controller.kind=relay", "controller.gain=2"], "controller.gain: a relay knows only the sign"),
        (["controller.derivative=2", "controller.kind=relay"], "give controller.derivative_time"),
        (["controller.kind=open-loop", "controller.gain=1"], "kind 'open-loop' does not have it, but 'pd'"),
        (["controller.kind=pd", "controller.derivative_time=1"], "kind 'pd' does not have it, but 'relay'"),
        (["controller.kind=python"], "controller.law: missing; kind 'python' needs it"),
    ],
)
def test_a_parameter_of_another_kind_is_refused_in_any_order(changes: list[str], said: str):
    with pytest.raises(ScenarioError) as error:
        load("step", changes)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_another_kind_keeps_what_it_knows_of_the_scenario_before(tmp_path: Path):
    """By --set as in a file that extends another: the gain of `step` stays with a function, and leaves for a relay."""
    found = load("step", ["controller.kind=python", "controller.law=mine:law"]).controller
    assert isinstance(found, Python)
    assert (found.gain, found.compensate_overlap) == ("1.0 V/%", True)
    path = tmp_path / "own.toml"
    path.write_text(
        'extends = "step"\n[controller]\nkind = "relay"\nlimit = 0.5\n[reference]\nkind = "ramp"\nrate = 0.1\n'
    )
    found = load(str(path))
    assert (found.controller.kind, found.controller.limit) == ("relay", 0.5)
    assert found.reference == load("step", ["reference.kind=ramp", "reference.rate=0.1"]).reference


def test_gains_are_those_of_the_kind():
    """1 V/% of 270 mm and 10 V is 37.04 / m."""
    gain = per_metre(1.0, 0.27, 10.0)
    assert law_gains(load("step")) == Gains(gain, 0.0, "measured", 20e-3, 10e-3, 1.0, load("step").rig.valve.overlap)
    relay = load("step", ["controller.kind=relay", "controller.derivative_time='50 ms'", "controller.limit=0.3"])
    assert law_gains(relay) == RelayGains(0.05, "measured", 20e-3, 10e-3, 0.3)
    assert law_gains(load("hold-load")) == OpenLoopGains(1.0)


def test_a_function_says_its_kind_itself(tmp_path: Path):
    path = tmp_path / "own.toml"
    path.write_text('extends = "step"\n[controller]\nlaw = "mine:law"\n')
    for found in (load("step", ["controller.law=mine:law"]), load(str(path))):
        assert found.controller.kind == "python"
    with pytest.raises(ScenarioError, match=r"controller\.law: 'mine:law' is a function of your own"):
        load("step", ["controller.kind=pd", "controller.law=mine:law"])


OLD = {"gain": "2.0 V/%", "derivative": "0.1 V s/%", "velocity": "measured", "filter_time": 0.02, "limit": 1.0}


@pytest.mark.parametrize(
    ("law", "own"),
    [
        ("pd", {"kind": "pd", **OLD, "compensate_overlap": True}),
        (
            "relay",
            {"kind": "relay", "velocity": "measured", "filter_time": 0.02, "limit": 1.0, "derivative_time": 0.05},
        ),
        ("open-loop", {"kind": "open-loop", "limit": 1.0}),
        ("mine:law", {"kind": "python", "law": "mine:law", **OLD, "compensate_overlap": True}),
    ],
)
def test_a_recording_that_names_its_law_the_old_way_still_opens(law: str, own: dict[str, Any]):
    scenario = load("step").model_dump(mode="json")
    old = {"scenario": scenario | {"controller": {"law": law, **OLD, "compensate_overlap": True}}}
    found = in_todays_words(old)
    assert found["scenario"]["controller"] == own
    assert check(found["scenario"], "old").controller.kind == own["kind"]
    assert in_todays_words(found) == found


def test_the_golden_recording_opens():
    assert read(GOLDEN).scenario().controller == load("step").controller


def test_a_recording_carries_its_kind(tmp_path: Path):
    scenario = load("step", ["duration=0.02", "controller.kind=relay", "controller.derivative_time=0.1"])
    record_in_process(scenario, tmp_path / "a.mcap")
    assert read(tmp_path / "a.mcap").scenario() == scenario
