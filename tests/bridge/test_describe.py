"""`hydrotwin describe`: every value with its source, what the scenario changed, what follows, and warnings."""

import json
import math
import re

import pytest

from bridge.scenario import ScenarioError, load, names
from bridge.scenario.circuit import circuit_of
from bridge.scenario.describe import (
    facts,
    shown_values,
    step_rows,
    values_of,
    warnings,
)
from bridge.scenario.relief_swing import swing_notes
from bridge.scenario.text_picture import text_picture
from tests.support.command import hydrotwin_here
from twin.circuit.pilot_swing import pilot_swings
from twin.rig import RIG

ALL = [f"{part}.{name}" for part, entries in RIG.items() for name in entries]


def test_every_value_of_the_rig_is_there_once_with_its_source():
    found = values_of(load("step"))
    assert [value.name for value in found] == ALL
    for value in found:
        part, _, name = value.name.partition(".")
        assert value.value
        assert value.source == RIG[part][name].source
        assert not value.changed


@pytest.mark.parametrize(
    ("change", "name", "shown", "otherwise"),
    [
        ("rig.load.mass='302 kg'", "load.mass", "302 kg", "120 kg"),
        ("rig.pump.speed='502 rpm'", "pump.speed", "502 rpm", "1230 rpm"),
        ("rig.pipe_3.length='2.5 m'", "pipe_3.length", "2.5 m", "2.05 m"),
        ("rig.pipe_3.model=nodes", "pipe_3.model", "nodes", "ends"),
        ("rig.cylinder.leakage_resistance=inf", "cylinder.leakage_resistance", "inf Pa s/m^3", "1733.33 bar/(l/min)"),
        ("rig.oil.temperature='60 degC'", "oil.temperature", "60 degC", "40.07 degC"),
    ],
)
def test_what_the_scenario_changed_is_marked_and_says_what_it_was(change, name, shown, otherwise):
    changed = [value for value in values_of(load("step", [change])) if value.changed]
    assert [value.name for value in changed] == [name]
    assert changed[0].value == shown
    assert changed[0].source == f"this scenario; otherwise {otherwise}"


def test_values_of_what_is_not_fitted_are_left_out_unless_the_scenario_changed_them():
    """The switching valve's numbers beside a proportional valve do nothing; a changed one is shown all the same."""
    own = {value.name for value in shown_values(load("step"))}
    assert {"valve.overlap", "pump.teeth", "relief.pilot_mass", "seal.alpha", "pipe_6.length"} <= own
    assert not [name for name in own if name.startswith(("switching_valve.", "pipe_7."))]
    changed = shown_values(load("step", ["rig.switching_valve.switching_time='40 ms'"]))
    odd = [value for value in changed if not value.fitted]
    assert [value.name for value in odd] == ["switching_valve.switching_time"]
    switching = {value.name for value in shown_values(load("step", ["rig.valve.kind=switching"]))}
    assert switching - own >= {"switching_valve.rated_flow", "switching_valve.idle_shuts"}
    assert own - switching >= {"valve.overlap", "valve.rated_flow"}


def test_all_values_are_printed_when_asked(tmp_path):
    few, every = (hydrotwin_here("describe", "step", *more, cwd=tmp_path).stdout for more in ((), ("--all",)))
    assert "switching_valve.idle_shuts" not in few
    assert "--all prints them" in few
    assert "switching_valve.idle_shuts" in every


def number(scenario, start: str) -> float:
    """The first number of a fact."""
    text = next(fact.value for fact in facts(scenario) if fact.what.startswith(start))
    return float(re.findall(r"-?\d+\.?\d*(?:e[+-]?\d+)?", text.removeprefix("p1 ="))[0])


def test_facts_are_those_of_the_rig():
    """26.7 l/min at 35 bar are 87.5 %; 67 bar at that flow, so a little less at rest; 1137 m/s; 40 mm^2/s; 184.5 Hz."""
    scenario = load("step")
    assert number(scenario, "oil:") == pytest.approx(40.0, rel=2e-3)
    assert number(scenario, "pump: mean flow") == pytest.approx(26.7 / 0.875, rel=1e-3)
    assert number(scenario, "pump: frequency") == pytest.approx(184.5)
    assert 66.0 < number(scenario, "supply") < 67.0
    assert 55.0 < number(scenario, "relief valve: cracking") < 67.0
    assert number(scenario, "relief valve: pilot") == pytest.approx(math.sqrt(811e3 / 10.6e-3) / 2 / math.pi, rel=1e-3)
    assert number(scenario, "pipe_1") == pytest.approx(1137.0, abs=0.5)
    assert len([fact for fact in facts(scenario) if fact.what.startswith("pipe_")]) == 6


def test_facts_of_what_is_not_fitted_are_left_out():
    bare = load("step", ["rig.relief.kind=none", "rig.pump.ripple=none"])
    assert not [fact for fact in facts(bare) if "relief valve:" in fact.what or "teeth" in fact.what]


@pytest.mark.parametrize("name", [name for name in names() if not re.search(r"-\d+$", name)])
def test_every_built_in_scenario_can_be_described(name):
    scenario = load(name)
    assert facts(scenario)
    assert step_rows(scenario)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (["rig.cylinder.rod=60 mm"], "cylinder.rod 0.06 m must be thinner than cylinder.bore 0.05 m"),
        (["rig.relief.kind=none", "rig.pump.efficiency=1"], "the pump flow has no outlet"),
    ],
)
def test_a_rig_without_a_state_of_rest_is_refused_in_one_line(changes, said):
    """By what describes it, and by what every run asks before it starts anything."""
    scenario = load("hold-load", changes)
    for ask in (facts, warnings):
        with pytest.raises(ScenarioError) as error:
            ask(scenario)
        assert len(str(error.value).splitlines()) == 1
        assert str(error.value).startswith(f"hold-load: {said}")


def test_a_pilot_that_swings_by_itself_is_said_and_a_calm_one_is_not():
    """The relief valve with a pump line of 1.5 m, 1.47 kHz at any flow; as fitted it is calm at the flow at rest.

    As fitted it swings at small flows: the fastest mode's growth changes its sign at 5.2 l/min. A run does not say so.
    """
    assert not swing_notes(load("step"))
    singing = load("step", ["rig.pipe_1.length=1.5"])
    said = [fact.value for fact in facts(singing) if "oscillates by itself" in fact.what]
    assert len(said) == 1
    assert float(said[0].split()[0]) == pytest.approx(1470.0, rel=2e-3)
    assert "up to 24.2 l/min" in said[0]
    assert said[0] in swing_notes(singing)[0]
    fitted = load("step")
    said = [fact.value for fact in facts(fitted) if "oscillates by itself" in fact.what]
    assert len(said) == 1
    assert said[0].endswith("calm at rest")
    edge, around = float(said[0].split()[1]) / 6e4, 0.02
    growths = [
        max(pilot_swings(fitted.rig_values(), circuit_of(fitted), edge * f))[0] for f in (1 - around, 1 + around)
    ]
    assert growths[0] > 0.0 > growths[1]


def test_a_step_too_coarse_is_marked_and_warned_of_with_both_numbers():
    """A wave's way through pipe 1 by its wave speed, and an eighth of it."""
    travel = float(circuit_of(load("step")).lines.travel_time[0])
    assert not warnings(load("step", ["loop.step='100 us'"]))
    coarse = load("step", ["loop.step='200 us'"])
    said = [line for line in warnings(coarse) if "pipe_1" in line]
    assert len(said) == 1
    numbers = f"{travel * 1e3:.3g} ms", f"at most {travel / 8 * 1e6:.3g} us"
    for word in ("loop.step 200 us", *numbers, "hydrotwin convergence"):
        assert word in said[0]
    marked = [part for part, _, _, longest in step_rows(coarse) if longest.endswith("TOO COARSE")]
    assert marked == ["pipe_1"]


def test_the_verb_prints_picture_values_facts_limits_and_warnings(tmp_path):
    done = hydrotwin_here("describe", "load-change-502", "--set", "loop.step='200 us'", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert text_picture(load("load-change-502").rig_values()) in done.stdout
    assert "switching valve" in done.stdout
    for word in ("load.added", "183 kg", "this scenario", "502 rpm", "Table 2.1", "TOO COARSE", "warning: loop.step"):
        assert word in done.stdout


def test_the_verb_prints_json_when_asked(tmp_path):
    found = json.loads(hydrotwin_here("describe", "step", "--set", "rig.load.mass=302", "--json", cwd=tmp_path).stdout)
    assert set(found) == {"values", "fitted", "facts", "step", "settings", "taps", "warnings"}
    assert [value["name"] for value in found["values"]] == ALL
    assert {row["slot"]: row["kind"] for row in found["fitted"]}["directional valve"] == "proportional valve"
    assert [value["name"] for value in found["values"] if value["changed"]] == ["load.mass"]
    assert {row["part"] for row in found["step"]} >= {"pipe_1", "load", "pump", "valve"}


def test_a_wrong_change_is_refused_by_the_verb(tmp_path):
    done = hydrotwin_here("describe", "step", "--set", "rig.load.mas=3", cwd=tmp_path)
    assert done.returncode == 2
    assert "did you mean 'mass'" in done.stderr
