"""Faults by chance, on conditions and live, and those that cannot be."""

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import hydrotwin as ht
from bridge.errors import ScenarioError, UsageError
from bridge.loop.exchange import exchange, sides
from bridge.processes.injection import injected_by
from bridge.recording.changes import changes as changes_in
from bridge.recording.manifest import manifest
from bridge.recording.writer import RecordingWriter
from bridge.replay.through import Through, replay_through
from bridge.runs.in_process import record_in_process
from bridge.scenario import Scenario, load
from bridge.scenario.faults import planned, targets
from tests.support.faults import faulty
from tests.support.processes import ROOT


def test_faults_come_again_by_chance_and_on_conditions(tmp_path: Path):
    """Each beginning by itself with its probability, the same for one seed; on a signal, and on an event."""
    many = '{target="sensor.p3", kind="off", at="10 ms", every="10 ms", times=60, lasts="2 ms", probability=0.5}'
    later = '{target="sensor.p2", kind="off", when="position > 110 mm", after="20 ms", lasts="50 ms", name="late"}'
    texts = []
    for seed in (1, 1, 2):
        run = record_in_process(faulty(many, later, seed=seed), tmp_path / f"{len(texts)}.mcap")
        told = [(event.text, event.apply_at) for event in run.messages("event") if event.kind == "fault"]
        texts.append(told)
        begun = sum("p3 off' begins" in text for text, _ in told)
        assert abs(begun - 30) < 4.0 * math.sqrt(15.0)
        state = run.columns("state")
        passed = int(state["stamp"][np.argmax(state["position"] > 0.11)])
        assert [at for text, at in told if text.startswith("'late' begins")] == [passed + 20_000_000]
    assert texts[0] == texts[1] != texts[2]
    assert any("'late' begins" in change.text for change in changes_in(run))


class Said(NamedTuple):
    """A run in which an operator has spoken, and its replay."""

    run: list[Any]  # messages
    answers: list[dict[str, Any]]
    verdict: Any

    def told(self) -> list[str]:
        """The texts of its events."""
        return [message.message.text for message in self.run if message.topic == "event"]

    def column(self, topic: str, name: str) -> Any:
        return np.array([getattr(m.message, name) for m in self.run if m.topic == topic])


def said(made: Scenario, orders: dict[int, list[dict[str, Any]]], folder: Path) -> Said:
    """A run in which queries come after a tick, and its replay into the plant."""
    plant, controller = sides(made)
    entries: list[Any] = []
    answers = []
    for tick, messages in enumerate(exchange(plant, controller, made.ticks)):
        entries += messages
        answers += [injected_by(json.dumps(order).encode(), made)(plant) for order in orders.get(tick, [])]
    path = folder / "run.mcap"
    writer = RecordingWriter(path, made.rig_name)
    writer.metadata("run", manifest(made, plant.run_id))
    writer.instant(entries)
    writer.close()
    return Said(entries, answers, replay_through(path, Through("plant", folder / "again.mcap", alone=True)))


def test_a_fault_that_is_injected_acts_at_once_and_comes_out_of_a_replay(tmp_path: Path):
    found = said(faulty(), {300: [{"target": "sensor.p2", "kind": "stuck", "lasts": "0.1 s"}]}, tmp_path)
    assert found.answers[0]["injected"] == "sensor.p2 stuck"
    assert found.verdict.events_differ is None
    assert {difference.greatest for difference in found.verdict.differences} == {0.0}
    assert any(text.startswith("injected {") for text in found.told())
    assert sum("'sensor.p2 stuck' begins" in text for text in found.told()) == 1


ENDED = [  # what each kind of target does, and the number or signal that tells that it is over
    {"target": "sensor.p2", "kind": "bias", "size": "20 bar"},
    {"target": "sensor.p2", "kind": "delay", "time": "30 ms"},
    {"target": "valve", "kind": "reversed"},
    {"target": "valve", "kind": "stuck"},
    {"target": "pump", "kind": "speed-drop", "over": "0.5 s"},
    {"target": "load", "kind": "jump", "mass": "60 kg"},
    {"target": "link.command", "kind": "delay", "time": "40 ms"},
]


@pytest.mark.parametrize("fault", ENDED, ids=lambda fault: f"{fault['target']} {fault['kind']}")
def test_a_fault_that_is_ended_is_as_if_it_had_lasted_so_long(fault: dict[str, str], tmp_path: Path):
    """To the bit: ended after 150 ms, or with `lasts` so from the beginning; and a replay repeats it.

    A scan of the instant itself was there before the operator spoke: for a sensor a step more.
    """
    name, lasts = f"{fault['target']} {fault['kind']}", "150 ms"
    if fault["target"].startswith("sensor"):
        lasts = "150.05 ms"
    patient = faulty(changes=("loop.command_timeout=1",))
    for place in (ended := tmp_path / "ended", lasted := tmp_path / "lasted"):
        place.mkdir()
    found = said(patient, {300: [fault], 450: [{"end": name}]}, ended)
    same = said(patient, {300: [fault | {"lasts": lasts}]}, lasted)
    assert found.answers[1]["ended"] == name
    for topic, signal in (("state", "position"), ("state", "p_pump"), ("measurement", "p2"), ("command", "spool")):
        assert (found.column(topic, signal) == same.column(topic, signal)).all(), signal
    turns = [text for text in found.told() if text.startswith(f"'{name}'")]
    assert [text.split()[2] for text in turns] == ["begins:", "ends:"]
    assert f"withdrawn '{name}'" in found.told()
    for each in (found, same):
        assert each.verdict.events_differ is None
        assert {difference.greatest for difference in each.verdict.differences} == {0.0}


@pytest.mark.parametrize("way", ["measurement", "command"])
def test_what_a_frozen_link_has_held_back_is_there_once_it_is_ended(way: str, tmp_path: Path):
    """Between 0.3 s and 0.45 s nothing passes, then all at once, and not after the 10 s that were said."""
    frozen = {"target": f"link.{way}", "kind": "freeze", "lasts": "10 s"}
    made = faulty(changes=("loop.command_timeout=1",))
    found = said(made, {300: [frozen], 450: [{"end": f"link.{way} freeze"}]}, tmp_path)
    heard = [m.log_time // 1_000_000 for m in found.run if m.topic == "measurement"]
    if way == "measurement":
        assert [tick for tick in heard if 301 < tick < 451] == []
        assert heard.count(451) >= 150
    reference = found.column("state", "reference")
    assert (reference[310:450] == reference[310]).all()
    assert reference[452] != reference[310]
    assert found.verdict.events_differ is None
    assert {difference.greatest for difference in found.verdict.differences} == {0.0}


def test_what_a_fault_would_have_done_later_does_not_come(tmp_path: Path):
    """One that comes again and again, one that waits, and both at one instant with others; each name once."""
    again = {"target": "sensor.p3", "kind": "off", "at": "0.35 s", "lasts": "20 ms", "every": "0.1 s", "times": 3}
    waits = {"target": "sensor.p2", "kind": "off", "when": "position > 500 mm", "name": "later"}
    at_once = {"target": "valve", "kind": "bias", "size": 0.1}
    orders = {300: [again, waits], 400: [{"end": "sensor.p3 off"}, {"end": "later"}, at_once, {"end": "valve bias"}]}
    found = said(faulty(), orders | {500: [at_once]}, tmp_path)
    turns = [text.partition(":")[0] for text in found.told() if "begins" in text or "ends" in text]
    assert turns == ["'sensor.p3 off' begins", "'sensor.p3 off' ends", "'valve bias from 0.5 s' begins"]
    assert found.verdict.events_differ is None
    assert {difference.greatest for difference in found.verdict.differences} == {0.0}


@pytest.mark.parametrize(
    ("order", "said"),
    [
        ({"end": "sensor.p2 of"}, "there is no fault 'sensor.p2 of'; did you mean 'sensor.p2 off'?"),
        ({"end": "sensor.p2 off"}, "the fault 'sensor.p2 off' is over already"),
        ({"end": "sensor.p2 off", "at": 1}, "to end a fault send its name alone"),
        ({"end": ["sensor.p2 off"]}, "to end a fault send its name alone"),
    ],
)
def test_what_cannot_be_ended_is_refused_in_one_line(order: dict[str, Any], said: str):
    made = faulty('{target="sensor.p2", kind="off", at="0.1 s", lasts="0.1 s"}')
    plant, controller = sides(made)
    for _ in exchange(plant, controller, 300):
        pass
    with pytest.raises(UsageError) as raised:
        injected_by(json.dumps(order).encode(), made)(plant)
    assert said in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ('{target="sensor.p9", kind="off", at=0}', "no target 'sensor.p9'; did you mean 'sensor.p"),
        ('{target="valve", kind="stuk", at=0}', "valve has no fault 'stuk'; did you mean 'stuck'?"),
        ('{target="valve", kind="stuck"}', 'give either at = "2 s" or when'),
        ('{target="valve", kind="stuck", at=0, size=1}', "valve stuck takes no size"),
        ('{target="sensor.p2", kind="bias", at=0}', "sensor.p2 bias needs size, a number in Pa: added"),
        ('{target="sensor.p2", kind="bias", at=0, size="3 mm"}', "unit 'mm' does not fit here"),
        ('{target="link.command", kind="loss", at=0, share=2}', "share = 2: must be from 0 to 1"),
        ('{target="link.command", kind="delay", at=0, law="gauss"}', "no law of delays 'gauss'"),
        ('{target="link.command", kind="freeze", at=0}', 'say how long, lasts = "0.2 s"'),
        ('{target="load", kind="jump", mass="-200 kg", at=0}', "rig.load.mass = -80: must be at least"),
        ('{target="sensor.p2", kind="wrong-channel", at=0, instead="p2"}', "instead = 'p2': one of position"),
        ('{target="process.controller", kind="crash", at=0}', "in one process there is none; use --mode realtime"),
        ('{target="valve", kind="stuck", at="0.12345 ms"}', "not a whole number (at least 0) of the internal step"),
    ],
)
def test_a_fault_that_cannot_be_is_refused_in_one_line(fault: str, said: str):
    with pytest.raises(ScenarioError) as raised:
        sides(faulty(fault))
    assert said in str(raised.value)
    assert "\n" not in str(raised.value)


def test_the_page_s_bad_day_passes_its_check(tmp_path: Path):
    page = (ROOT / "docs/faults.md").read_text(encoding="utf-8")
    (tmp_path / "bad-day.toml").write_text(page.partition("```toml\n")[2].partition("```")[0], encoding="utf-8")
    run = ht.run(tmp_path / "bad-day.toml")
    assert run.passed, (run.faults, run.bands)


def test_every_target_and_kind_is_in_the_page():
    """docs/faults.md names each."""
    page = (ROOT / "docs/faults.md").read_text(encoding="utf-8")
    for target, kinds in targets(load("step")):
        assert f"`{target.partition('.')[0]}" in page
        for kind in kinds:
            assert f"`{kind}`" in page, kind
    assert planned(load("step")) == []
