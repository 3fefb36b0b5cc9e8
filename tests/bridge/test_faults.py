"""Faults by chance, on conditions and live, and those that cannot be."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hydrotwin as ht
from bridge.errors import ScenarioError
from bridge.loop.exchange import exchange, sides
from bridge.processes.injection import injected_by
from bridge.recording.changes import changes as changes_in
from bridge.recording.manifest import manifest
from bridge.recording.writer import RecordingWriter
from bridge.replay.through import Through, replay_through
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
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


def test_a_fault_that_is_injected_acts_at_once_and_comes_out_of_a_replay(tmp_path: Path):
    made = faulty()
    plant, controller = sides(made)
    asked = injected_by(b'{"target": "sensor.p2", "kind": "stuck", "lasts": "0.1 s"}', made)
    entries: list[Any] = []
    answer: dict[str, Any] = {}
    for tick, messages in enumerate(exchange(plant, controller, made.ticks)):
        entries += messages
        if tick == 300:
            answer = asked(plant)
    assert answer["injected"] == "sensor.p2 stuck"
    path = tmp_path / "run.mcap"
    writer = RecordingWriter(path, made.rig_name)
    writer.metadata("run", manifest(made, plant.run_id))
    writer.instant(entries)
    writer.close()
    verdict = replay_through(path, Through("plant", tmp_path / "again.mcap", alone=True))
    assert verdict.events_differ is None
    assert {difference.greatest for difference in verdict.differences} == {0.0}
    told = [message.message.text for message in entries if message.topic == "event"]
    assert any(text.startswith("injected {") for text in told)
    assert sum("'sensor.p2 stuck' begins" in text for text in told) == 1


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
