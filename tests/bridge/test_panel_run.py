"""What the panel makes of the messages of a run: curves, the latest state, bands, estimates and health."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bridge.loop.exchange import exchange, sides
from bridge.panel.clients import packed
from bridge.panel.numbers import for_page
from bridge.panel.run import Run
from bridge.panel.series import dtype_of
from bridge.recording.entries import Entry
from bridge.recording.manifest import manifest
from bridge.scenario import Scenario, load
from bridge.scenario.tunable import tunables
from bridge.wire.codec import HEADER, Signals, encode
from twin.estimation.hypotheses import Verdict
from twin.estimation.quantities import Standing

EXPECTED = 'expect=["peak p1 <= 10 bar", "peak p1 <= 200 bar", "mean position from 0.9 s to 1 s >= 50 mm"]'


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load("step", ["duration=1", EXPECTED])


@pytest.fixture(scope="module")
def entries(scenario: Scenario) -> list[Entry]:
    """All messages of the run, in process."""
    plant, controller = sides(scenario)
    sent = [m for tick in exchange(plant, controller, scenario.ticks) for m in tick]
    return [Entry(m.topic, m.log_time, m.sequence, encode(m.message)) for m in sent]


def run_of(scenario: Scenario, entries: list[Entry]) -> Run:
    run_id = int.from_bytes(entries[0].data[4:12], "little")
    told = manifest(scenario, run_id) | {"tick": 0}
    rig: Any = SimpleNamespace(manifest=told, run_id=run_id, scenario=scenario, heed=lambda status: None)
    return Run(rig)


def row(topic: str, run_id: int, **values: float) -> Entry:
    """A flat message of which only some fields are known."""
    made = np.zeros(1, dtype_of(topic))
    for name in made.dtype.names or ():
        made[name] = values.get(name, np.nan if made.dtype[name].kind == "f" else 0)
    made["run_id"] = run_id
    return Entry(topic, 0, 0, HEADER + made.tobytes())


def test_a_run_becomes_curves_a_picture_and_events(scenario: Scenario, entries: list[Entry]):
    """In the units of people: the greatest pressure of the frame is that of the messages, in bar."""
    run = run_of(scenario, entries)
    part = run.take(entries)
    states = np.frombuffer(b"".join(e.data[4:] for e in entries if e.topic == "state"), dtype_of("state"))
    assert max(part["curves"]["state"]["v"]["state.p1"]) == pytest.approx(states["p1"].max() * 1e-5, abs=1e-3)
    assert part["now"]["position"] == pytest.approx(states["position"][-1], rel=1e-4)
    assert np.shape(part["lines"]) == (6, 11)
    assert part["events"][0]["kind"] == "started"
    assert run.detail(0.5, 0.6)["state"]["t"][0] == 0.5
    assert run.time == 1.0


def test_bands_turn_red_while_it_runs(scenario: Scenario, entries: list[Entry]):
    """A broken band is red at once, one that cannot be told yet is open, and at the end each is judged."""
    run = run_of(scenario, entries)
    run.take([entry for entry in entries if entry.log_time <= 600_000_000])
    assert run.judging.look(ended=False)
    assert [band["passed"] for band in run.judging.found] == [False, True, None]
    assert not run.judging.look(ended=False)  # nothing new has come
    run.take([entry for entry in entries if entry.log_time > 600_000_000])
    assert run.judging.look(ended=False)
    assert [band["passed"] for band in run.judging.found] == [False, True, True]


def test_a_run_whose_beginning_was_not_seen_is_not_judged(scenario: Scenario, entries: list[Entry]):
    run = run_of(scenario, entries)
    run.take([entry for entry in entries if entry.log_time > 600_000_000])
    assert not run.judging.look(ended=True)
    assert "the panel came at" in run.judging.words


def test_a_rig_without_a_true_state_shows_what_is_estimated_else_read(scenario: Scenario, entries: list[Entry]):
    """Of a follower's estimate its deviations and its verdict, too; what is not known is null on the page."""
    run = run_of(scenario, entries)
    card = [entry for entry in entries if entry.topic == "measurement"]
    now = run.take(card)["now"]
    assert set(now) == {"position", "velocity", "p1", "p_lower", "p_upper"}
    known = {"p_lower": 50e5, "p_lower_sd": 1e5, "unknown_leakage": 2.0, "unknown_leakage_sd": 0.1}
    followed = row("estimate", run.rig.run_id, standing=Standing.FOLLOWING, **known)
    judged = row(
        "health",
        run.rig.run_id,
        verdict=Verdict.FAULT,
        first=0,
        confidence=0.9,
        since=3.0,
        limit=5.0,
        leak_across_deviate=8.0,
        leak_across_size=np.log(2.0),
        leak_across_size_sd=0.05,
    )
    part = run.take([followed, judged])
    assert part["now"]["p_lower"] == 50e5
    assert part["estimate"]["standing"] == "following"
    assert ["leak across the piston", 2.0, 0.1, "times"] in part["estimate"]["rows"]
    assert part["health"]["bad"]
    assert part["health"]["verdict"].startswith("leak across the piston, 2 times")
    assert "NaN" not in packed("frame", part)


def test_messages_of_another_run_and_of_other_lengths_are_left_out(scenario: Scenario, entries: list[Entry]):
    run = run_of(scenario, entries)
    part = run.take([row("state", 1), Entry("state", 0, 0, entries[0].data[:12] + b"short")])
    assert not any(part.values())


def test_signals_are_shown_by_the_names_that_came_first(scenario: Scenario, entries: list[Entry]):
    """Another controller that logs others, or none, does not end the panel."""
    run = run_of(scenario, entries)

    def logged(names: list[str], units: list[str]) -> Any:
        head = {"run_id": run.rig.run_id, "source": 1, "sequence": 0, "stamp": 0}
        message = Signals(**head, names=names, units=units, values=np.ones(len(names)))
        return run.take([Entry("signals", 0, 0, encode(message))])["curves"]

    assert logged([], []) == {}
    assert logged(["force"], ["N"])["signals"]["v"] == {"signals.force": [1.0]}
    assert logged(["other"], ["m"]) == {}


def test_numbers_are_those_of_what_is_fitted_in_the_units_of_people(scenario: Scenario):
    """0.1 m on a slider of 0 to 270 mm; a gain in volts per %; nothing of a pump that is not there."""
    asked = [entry._asdict() for entry in tunables(scenario).values()]
    rows = {found["name"]: found for found in for_page(asked, scenario)}
    assert rows["reference"]["slider"] == [0.0, 270.0]
    assert (rows["controller.gain"]["unit"], rows["controller.gain"]["value"]) == ("V/%", pytest.approx(1.0))
    assert rows["rig.relief.setting"]["value"] == pytest.approx(67.0)
    assert rows["rig.load.force"]["slider"] == pytest.approx([-3 * 120 * 9.81, 3 * 120 * 9.81])
    assert not [name for name in rows if name.startswith("rig.fixed_pump")]
