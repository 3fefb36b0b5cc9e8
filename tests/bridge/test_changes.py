"""What changes while a run goes on: exact to the internal step, the same by every way through the loop, oil kept."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hydrotwin as ht
from bridge.errors import ScenarioError
from bridge.loop.exchange import exchange, sides
from bridge.recording.digest import digest
from bridge.recording.manifest import manifest
from bridge.recording.reader import Recording, recording
from bridge.recording.writer import entries_of
from bridge.replay.into_controller import heard, through_side
from bridge.replay.into_plant import through_plant
from bridge.runs.in_process import record_in_process, run_in_memory
from bridge.scenario import Scenario, load
from bridge.scenario.circuit import circuit_of, rest_of
from bridge.scenario.tunable import tunables
from controller.grid import NS
from tests.support.processes import ROOT, run_recorded
from twin.circuit.block import block_of, buffers, compiled
from twin.circuit.build import rebuild
from twin.topology import OBSERVED

PAGE = (ROOT / "docs/timeline.md").read_text(encoding="utf-8")
LUMPED = [f"rig.pipe_{number}.model=lumped" for number in range(1, 7)]
EVERY_KIND = (
    '{set="rig.load.force", at="0.2 s", to="-800 N", lasts="50 ms", every="0.3 s", times=3}',
    '{set="rig.load.mass", at="0.4 s", to="183 kg", over="0.2 s"}',
    '{set="rig.pump.speed", at="0.3 s", amplitude="2 1/s", frequency="3 Hz", lasts="0.5 s"}',
    '{set="rig.oil.temperature", at="0.50005 s", to="52 degC"}',
    '{set="rig.relief.setting", at="0.7 s", to="55 bar"}',
    '{set="rig.cylinder.leakage_resistance", at="0.2 s", to=1e12}',
    '{set="rig.seal.limit", at="0.6 s", table=[[0, 0.25], ["0.1 s", 0.1], ["0.2 s", 0.25]]}',
    '{set="rig.filter.drop", when="p2 > 40 bar", to="2 bar"}',
    '{set="sensor.p2.offset", at="0.1 s", to="3 bar", over="0.5 s"}',
    '{set="sensor.p3.noise", at="0.25 s", to=4}',
    '{set="controller.gain", at="0.3 s", to="0.6 V/%", over="0.3 s"}',
    '{set="reference", when="position > 110 mm", after="0.1 s", amplitude="5 mm", frequency="2 Hz"}',
    '{set="controller.limit", when="safe", to=0.5}',
)


def with_timeline(*entries: str, changes: tuple[str, ...] = (), duration: float = 1.0) -> Scenario:
    """The step at 0.1 s, and a timeline."""
    own = ("reference.at=0.1", f"duration={duration}", f"timeline=[{', '.join(entries)}]")
    return load("step", [*own, *changes])


def missing_oil(state: dict[str, Any]) -> float:
    """What the books lack, over the oil there was."""
    crossed = state["oil_pumped"] - state["oil_relieved"] - state["oil_returned"]
    stored = state["oil_stored"]
    return float(np.abs((stored - stored[0] - (crossed - crossed[0])) / stored[0]).max())


def test_a_change_acts_at_its_internal_step():
    """An open loop whose load is pushed 7 steps after a scan: the same bits as two circuits one after the other."""
    still = (
        "controller.kind=open-loop",
        "reference.start=0",
        "reference.end=0.4",
        "daq.quantise_output=false",
        "loop.delay=0",
    )
    push = '{set="rig.load.force", at="0.15035 s", to="900 N"}'
    scenario = with_timeline(push, changes=still, duration=0.2)
    seen = run_in_memory(scenario).columns("state")

    before, rig = circuit_of(scenario), scenario.rig_values()
    rig["load"]["force"] = 900.0
    state, (taps, observed) = rest_of(scenario), buffers()
    for circuit, reference, steps in (
        (before, 0.0, 2000),
        (before, 0.4, 1007),
        (rebuild(before, rig, "load.force"), 0.4, 993),
    ):
        block_of(compiled(circuit))(state, reference, steps, taps, observed)
    for name, value in zip(OBSERVED, observed.tolist(), strict=True):
        assert seen[name][-1] == value, name


def test_oil_is_kept_through_every_kind_of_change():
    softer = '{set="rig.oil.wave_speed", at="0.45 s", to="1000 m/s", over="0.1 s"}'
    for entries, changes in ((EVERY_KIND, ()), ((*EVERY_KIND, softer), tuple(LUMPED))):
        state = run_in_memory(with_timeline(*entries, changes=changes)).columns("state")
        assert missing_oil(state) < 1e-12
        assert {120.0, 183.0} <= set(state["mass"])
        assert all(np.isfinite(column).all() for column in state.values())


def test_a_change_of_the_load_gives_the_energy_of_its_definition():
    """Hanging still with the valve shut: the state does not jump, so that only m g x and the like do."""
    scenario = with_timeline('{set="rig.load.mass", at="0.05 s", to="200 kg"}', duration=0.1)
    seen = run_in_memory(scenario).columns("state")
    at = int(np.searchsorted(seen["stamp"], 50_000_000))
    plain = run_in_memory(with_timeline(duration=0.1)).columns("state")
    for name in ("position", "velocity", "p_lower", "p_upper", "oil_stored"):
        assert (seen[name][: at + 1] == plain[name][: at + 1]).all(), name
    assert seen["velocity"][at + 1] < plain["velocity"][at + 1]


NUMBERS = st.one_of(
    st.tuples(st.just("rig.load.force"), st.floats(-2000.0, 2000.0)),
    st.tuples(st.just("rig.load.mass"), st.floats(60.0, 400.0)),
    st.tuples(st.just("rig.pump.speed"), st.floats(0.0, 30.0)),
    st.tuples(st.just("rig.seal.limit"), st.floats(0.0, 0.4)),
    st.tuples(st.just("rig.valve.overlap"), st.floats(0.0, 0.3)),
    st.tuples(st.just("sensor.p2.offset"), st.floats(-20e5, 20e5)),
    st.tuples(st.just("controller.derivative"), st.floats(0.0, 0.1)),
    st.tuples(st.just("reference"), st.floats(0.0, 0.27)),
)
SHAPES = st.sampled_from(["", ', over="0.05 s"', ', lasts="0.03 s"'])
BEGINS = st.one_of(
    st.integers(0, 7000).map(lambda k: f"at={k * 50e-6!r}"),
    st.sampled_from(['when="p2 > 30 bar"', 'when="velocity < 0"', 'when="position > 0.12", after="10 ms"']),
)
ENTRIES = st.builds(lambda n, s, b: f'{{set="{n[0]}", to={n[1]!r}{s}, {b}}}', NUMBERS, SHAPES, BEGINS)


@given(st.lists(ENTRIES, min_size=1, max_size=6))
@settings(max_examples=15)
def test_random_timelines_keep_the_oil_and_come_out_again(entries: list[str]):
    """Into the plant and into the controller with residual 0, since all that happens is in the recording."""
    scenario = with_timeline(*entries, duration=0.4)
    run = run_in_memory(scenario)
    assert missing_oil(run.columns("state")) < 1e-12
    assert_comes_out_again(run, scenario)


def assert_comes_out_again(run: Recording, scenario: Scenario) -> None:
    """Replayed into plant and controller: the same bytes."""
    recorded = {(e.topic, e.log_time): e.data for e in run.entries}
    replays = through_plant(run, scenario), through_side(heard(run, scenario), sides(scenario)[1])
    for replay, topics in zip(replays, (("measurement", "state"), ("command", "reference")), strict=True):
        found = [entry for messages in replay for entry in entries_of(messages) if entry.topic in topics]
        assert sum(entry.topic == topics[0] for entry in found) == run.counts[topics[0]]
        for entry in found:
            own = recorded[entry.topic, entry.log_time]
            source = slice(12, 20) if entry.topic in ("command", "reference") else slice(0, 0)
            assert entry.data.replace(entry.data[source], b"") == own.replace(own[source], b""), entry.topic


def test_settings_at_random_come_out_again():
    """Numbers of rig, sensors and controller, set between ticks of a run."""
    scenario = load("square", ["duration=0.9", "loop.sample_period=2 ms"])
    plant, controller = sides(scenario)
    rng, entries, ticks = np.random.default_rng(3), [], scenario.ticks
    wanted = {
        "rig.load.force": (-500.0, 500.0),
        "rig.pump.speed": (15.0, 22.0),
        "sensor.p2.offset": (-1e5, 1e5),
        "controller.gain": (5.0, 40.0),
        "controller.derivative": (0.0, 0.3),
        "reference": (0.05, 0.2),
    }
    due = set(rng.choice(ticks, 300, replace=False).tolist())
    for messages in exchange(plant, controller, ticks):
        entries += entries_of(messages)
        if plant.tick_number in due:
            name = str(rng.choice([*wanted]))
            plant.set({name: float(rng.uniform(*wanted[name]))}, over=int(rng.choice([0, 20_000_000])))
    run = recording(Path("memory"), entries, {"run": manifest(scenario, plant.run_id)})
    told = [event for event in run.messages("event") if event.kind == "changed"]
    assert len(told) == 300
    assert_comes_out_again(run, scenario)


def test_the_loop_is_the_same_in_lockstep(tmp_path: Path):
    """Conditions, events and all: the same bytes by three processes as by none."""
    file = tmp_path / "own.toml"
    entries = "\n".join("[[timeline]]\n" + e[1:-1].replace(", ", "\n") + "\n" for e in EVERY_KIND if "table" not in e)
    step = '[reference]\nkind = "step"\nstart = 0.1\nend = 0.16\nat = 0.1\n'
    file.write_text(f'extends = "step"\nduration = 1.0\nexpect = []\n{step}{entries}')
    wired = run_recorded(tmp_path / "wired.mcap", str(file), "--mode", "lockstep")
    alone = record_in_process(load(str(file)), tmp_path / "alone.mcap")
    assert digest(wired.path) == digest(alone.path)
    kinds = [event.text.split(":")[0] for event in wired.messages("event") if event.kind == "changed"]
    assert {"timeline 8", "timeline 11"} <= set(kinds)


def test_a_gain_acts_from_its_sample_on_and_a_condition_from_the_next():
    """With the gain at zero the command is zero; the condition is met at a scan and heard at the next sample."""
    zero = '{set="controller.gain", at="0.205 s", to="0 V/%"}'
    seen = run_in_memory(with_timeline(zero, duration=0.3))
    command = seen.columns("command")
    off = command["sample_stamp"] >= 205_000_000
    assert np.all(command["spool"][off] == 0.0)
    assert command["spool"][~off][-1] != 0.0
    crossed = run_in_memory(with_timeline('{set="controller.gain", when="position > 0.11", to="0 V/%"}', duration=0.3))
    told = next(event for event in crossed.messages("event") if event.kind == "changed")
    state, command = crossed.columns("state"), crossed.columns("command")
    first = state["stamp"][np.argmax(state["position"] > 0.11)]
    assert told.apply_at == told.stamp == first
    assert np.all((command["spool"] == 0.0)[command["sample_stamp"] > first])


def test_an_entry_happens_as_often_as_it_says():
    """The piston goes up and down past 130 mm: twice of four times."""
    wave = ("reference.kind=sine", "reference.mean=130 mm", "reference.amplitude=25 mm", "reference.frequency=2 Hz")
    entry = '{set="rig.load.force", when="position > 130 mm", to="100 N", lasts="10 ms", times=2}'
    run = run_in_memory(with_timeline(entry, changes=(*wave, "start.position=130 mm"), duration=2.5))
    told = [event for event in run.messages("event") if event.kind == "changed"]
    above = run.columns("state")["position"] > 0.13
    assert (np.diff(above.astype(int)) == 1).sum() > 2
    assert len(told) == 2


def test_the_page_s_scenario_passes_its_check(tmp_path: Path):
    """The push of 1500 N is held within 3 mm; the gain follows its condition."""
    file = tmp_path / "push.toml"
    file.write_text(PAGE.partition("```toml\n")[2].partition("```")[0])
    run = ht.run(file)
    assert run.passed, (run.faults, run.bands)
    told = {event.command: event.apply_at for event in run.recording.messages("event") if event.kind == "changed"}
    assert told[1] == 2 * NS
    assert told[3] > 1.5 * NS


def test_sensors_read_what_their_changes_say():
    """At rest an offset is exact to a bit; noise has its own width, and other channels keep their bits."""
    quiet = ("daq.noise=0", "daq.skew=0", "controller.gain=0 V/%")
    offset = '{set="sensor.p2.offset", at="0.1 s", to="3 bar", lasts="0.1 s"}'
    seen = run_in_memory(with_timeline(offset, changes=quiet, duration=0.3))
    measured, true = seen.columns("measurement"), seen.columns("state")["p_lower"]
    apart = measured["p2"] - true
    inside = (measured["stamp"] >= 100_000_000) & (measured["stamp"] < 200_000_000)
    lsb = 250e5 / 4096
    assert np.abs(apart[inside] - 3e5).max() <= lsb
    assert np.abs(apart[~inside]).max() <= lsb
    noisy = '{set="sensor.p1.noise", at=0, to=40}'
    seen, plain = (run_in_memory(with_timeline(*e, duration=0.3)).columns("measurement") for e in ((noisy,), ()))
    assert 30 * lsb < np.std((seen["p1"] - plain["p1"])[:100]) < 50 * lsb
    assert (seen["p2"][:100] == plain["p2"][:100]).all()


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        (
            'set="rig.load.force", at="0.10001 s", to=1',
            "at 0.10001 s is not a whole number .* nearest: 0.1 or 0.10005 s",
        ),
        ('set="rig.load.force", at=0.1, to=1, lasts="20 us"', "lasts 2e-05 s is not a whole number"),
        ('set="rig.load.forse", at=0.1, to=1', "did you mean 'rig.load.force'"),
        ('set="rig.cylinder.bore", at=0.1, to=1', "cannot change while the rig runs: it is the rig's geometry"),
        ('set="rig.load.mass", at=0.1, to="-3 kg"', "rig.load.mass = -3: must be at least"),
        ('set="rig.load.mass", at=0.1, to="3 bar"', "unit 'bar' does not fit here"),
        ('set="rig.load.mass", at=0.1, amplitude="130 kg", frequency=1', "rig.load.mass = -10: must be"),
        ('set="controller.limit", at=0.1, to=2', "controller.limit"),
        ('set="controller.gian", at=0.1, to=2', "did you mean 'controller.gain'"),
        ('set="rig.load.force", to=1', "give either at"),
        ('set="rig.load.force", at=0.1, when="safe", to=1', "give either at"),
        ('set="rig.load.force", at=0.1', "nothing given; write to"),
        ('set="rig.load.force", at=0.1, to=1, frequency=2', "frequency, to given; write to"),
        ('set="rig.load.force", at=0.1, to=1, times=3', "every and times go together"),
        ('set="rig.load.force", when="p9 > 3 bar", to=1', "no signal 'p9'"),
        ('set="rig.load.force", when="rarely", to=1', "write 'signal > value unit', or one of safe"),
        ('set="rig.load.force", at=0.1, table=[[1, 2], [2, 3]]', "times count from the beginning"),
    ],
)
def test_what_cannot_happen_is_refused_with_its_entry(entry: str, said: str):
    with pytest.raises(ScenarioError, match=f"timeline 1: .*{said}"):
        with_timeline(f"{{{entry}}}")


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ('{set="rig.load.mass", at=0.1, to="2 g"}', "rig.load.mass = 0.002: load.mass 0.002 kg swings too fast"),
        (
            '{set="rig.oil.wave_speed", at=0.1, to="900 m/s"}',
            "model 'lumped', 'volume' or 'none' can take that",
        ),
    ],
)
def test_what_the_rig_cannot_be_is_refused_before_the_run(entry: str, said: str):
    with pytest.raises(ScenarioError, match=said):
        sides(with_timeline(entry))


def test_every_number_that_may_change_can_be_set():
    """A little more of each, by name, in the middle of a run: the run goes on and the event says so."""
    scenario = load("step", ["duration=0.5", "loop.command_timeout=1", "rig.pump.run_up=0", *LUMPED])
    plant, controller = sides(scenario)
    for _ in exchange(plant, controller, 2):
        pass
    for name, (entry, value) in plant.values().items():
        high = math.inf if entry.high is None else entry.high
        then = min(value + (0.01 * abs(value) or 1e-3), high)
        plant.set({name: then})
        told = [m.message.text for m in plant.tick() if m.topic == "event"]
        assert told == [f"{name} = {then!r}"]
    assert len(tunables(scenario)) > 80


LAW = """\
from pydantic import BaseModel, Field


class Parameters(BaseModel):
    kp: float = Field(gt=0.0)


def law(sample, target, memory, gains):
    return 0.1 * gains.parameters.kp, memory
"""
KIND = ("controller.kind=python", "controller.law=own.py:law", "controller.parameters.kp=1")


def test_parameters_of_a_law_change_as_its_declaration_allows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """By the timeline only what it takes; what somebody sets and it refuses is told, and the number before stays."""
    monkeypatch.chdir(tmp_path)
    Path("own.py").write_text(LAW)
    ramp = '{set="controller.parameters.kp", at="0.1 s", to=2, over="0.1 s"}'
    spool = run_in_memory(with_timeline(ramp, changes=KIND, duration=0.3)).columns("command")["spool"]
    assert spool[[5, 15, 25]] == pytest.approx([0.1, 0.15, 0.2])
    with pytest.raises(ScenarioError, match=r"kp: 0\.0 must be greater than 0"):
        sides(with_timeline(ramp.replace("to=2", "to=0"), changes=KIND))
    plant, controller = sides(with_timeline(changes=KIND, duration=0.1))
    said = []
    for messages in exchange(plant, controller, 100):
        said += [m.message.text for m in messages if m.topic == "said"]
        if plant.tick_number == 20:
            plant.set({"controller.parameters.kp": -1.0})
    assert len(said) == 1
    assert said[0].startswith("refused, the numbers before stay: controller.parameters.kp")
    assert plant.inlet.value == pytest.approx(0.1)


def test_settings_are_all_taken_or_none():
    plant, _ = sides(load("step", ["duration=0.5"]))
    plant.start()
    with pytest.raises(ScenarioError, match="swings too fast"):
        plant.set({"rig.load.force": 100.0, "rig.load.mass": 1e-3})
    assert plant.values()["rig.load.force"][1] == 0.0
    assert not [m for m in plant.tick() if m.topic == "event"][1:]
