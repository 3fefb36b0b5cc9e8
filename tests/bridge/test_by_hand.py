"""A run put together by hand: mixed scenarios are noticed, terminals tell, foreign controllers are judged fairly."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from bridge.loop.exchange import exchange, sides
from bridge.machine.narrator import Narrator
from bridge.recording.columns import followed, reference_at
from bridge.recording.entries import Entry
from bridge.recording.info import describe
from bridge.recording.reader import read, recording
from bridge.scenario import load
from bridge.scenario.sameness import difference, digest_of
from bridge.wire.bus import STAMP
from bridge.wire.codec import encode
from bridge.wire.guide import GUIDE, TOKEN
from bridge.wire.link import DEFAULT_ENDPOINT, free_endpoint
from bridge.wire.messages import TOPICS, Reason
from controller.law import per_metre
from tests.support.processes import ROOT, hydrotwin, listening, started, wait_for


def test_scenarios_are_the_same_by_what_plant_and_controller_do():
    ours = load("step")
    again = json.loads(ours.model_dump_json())
    assert difference(ours, again) == ""
    assert digest_of(load("step", ["title=another", "real_time.length=9", "duration=20.0"])) == digest_of(ours)
    assert digest_of(load("step", ["controller.gain=2"])) != digest_of(ours)
    assert digest_of(ours) < 2**53  # exact as a float64


def test_a_difference_is_named_by_its_keys():
    words = difference(load("step", ["controller.gain=2", "loop.delay=0"]), load("step").model_dump(mode="json"))
    assert words == "scenario 'step', the plant 'step': they differ in controller.gain, loop.delay"
    assert "reference.kind" in difference(load("sine"), load("step").model_dump(mode="json"))


def test_a_plant_and_a_controller_of_different_scenarios_say_so_everywhere(tmp_path: Path):
    """In each terminal, as an event, and in `info`; the run itself goes on."""
    endpoint, path = free_endpoint(), tmp_path / "a.mcap"
    lockstep = ("--mode", "lockstep")
    awaited = ("--await", "controller", "--await", "recorder", "--patience", "60")
    with started("plant", "step", "--set", "duration=2", *lockstep, *awaited, "--listen", endpoint) as plant:
        wait_for(lambda: listening(endpoint), 60)
        with started("record", *lockstep, "--connect", endpoint, "-o", str(path)) as recorder:
            controller = hydrotwin("controller", "sine", *lockstep, "--connect", endpoint)
            recorded, _ = recorder.communicate(timeout=60)
        said, _ = plant.communicate(timeout=60)
    mixed = "runs scenario 'sine', the plant 'step': they differ in "
    assert [mixed in text for text in (controller.stderr, recorded, said)] == [True] * 3
    assert f"listening on {endpoint}" in said
    assert "controller " in said
    assert "has joined" in said
    assert any(mixed in note for note in describe(read(path)).notes)


def published(change: float) -> list[Entry]:
    """Tick for tick a short run whose controller publishes its reference shifted by so much [m]."""
    plant, controller = sides(load("step", ["duration=0.1"]))
    entries = []
    for messages in exchange(plant, controller, 100):
        for m in messages:
            if m.topic == "reference":
                m.message.position += change
            entries.append(Entry(m.topic, m.log_time, m.sequence, encode(m.message)))
    return entries


def test_a_run_is_judged_against_the_reference_that_its_controller_publishes():
    """Where that is the scenario's it is evaluated between the samples, too; else it is held from sample to sample."""
    scenario, time = load("step", ["duration=0.1"]), np.arange(101) * 1e-3
    own = reference_at(time, scenario)
    same, other = (recording(Path("a.mcap"), published(shift), {}) for shift in (0.0, 0.03))
    assert np.array_equal(followed(same, scenario, time), own)
    assert np.allclose(followed(other, scenario, time), own + 0.03, 0.0, 1e-12)


def test_a_held_reference_changes_at_its_samples():
    scenario = load("sine", ["duration=0.1"])
    entries = [e._replace(data=e.data) for e in published(0.0)]
    found = followed(recording(Path("a.mcap"), entries, {}), scenario, np.array([0.0, 0.0099, 0.01]))
    assert found == pytest.approx([0.1, 0.1, 0.1])


def test_the_guide_to_a_controller_of_ones_own_is_true():
    """Address, token, attachment, topics and keys of the scenario are those of the code and of the example."""
    example = (ROOT / "examples" / "foreign_controller.py").read_text()
    assert DEFAULT_ENDPOINT in GUIDE
    assert f"rig/{TOKEN}/" in example
    assert "<rig>/alive/controller/NUMBER" in GUIDE
    assert struct.calcsize("<qQ") == STAMP.size == 16
    assert "struct` <qQ" in GUIDE
    named = {word.partition("/")[2].strip(":;,.") for word in GUIDE.split() if word.startswith("<rig>/")}
    own = {"scenario", "parameters", "parameters/set", "fault", f"{TOKEN}/NUMBER", "alive/plant/*"}
    assert named - set(TOPICS) == own
    assert all(reason in GUIDE for reason in Reason)
    scenario = load("step").model_dump()
    keys = {"sample_period", "offset", "delay", "daq_period", "step", "command_timeout", "after_timeout"}
    assert keys <= set(scenario["loop"])
    assert {"stroke", "full_scale", "overlap"} <= {*scenario["rig"]["cylinder"], *scenario["rig"]["valve"]}


def test_the_guide_s_gain_in_volts_is_the_scenario_s():
    """K V/% is K * 100 / stroke / full_scale [1/m]."""
    rig = load("step").rig
    assert per_metre(0.7, rig.cylinder.stroke, rig.valve.full_scale) == pytest.approx(
        0.7 * 100.0 / rig.cylinder.stroke / rig.valve.full_scale
    )


def test_a_narrator_says_who_joins_and_leaves_once():
    said: list[str] = []
    narrator = Narrator(quiet=False, write=said.append)
    for present in ({"controller": {"7"}, "plant": {"1"}}, {"controller": {"7"}}, {"controller": set()}):
        narrator.note_present(present, "plant")
    narrator.close()
    assert said == ["controller 7 has joined", "controller 7 has left"]
