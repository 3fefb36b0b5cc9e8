"""The loop driven from outside is the loop of a law, byte for byte; rigs for one use leave nothing behind."""

import math
from pathlib import Path

import pytest

import bridge.scenario.circuit as circuits
from bridge.loop.exchange import exchange, sides
from bridge.loop.stepped import SteppedLoop
from bridge.recording.writer import entries_of
from bridge.scenario import Scenario, load
from controller.grid import NS
from controller.laws import ControlLaw
from tests.support.plant import relief_of
from twin.circuit.build import build
from twin.topology import OBSERVED


def wish(stamp: int) -> float:
    """A spool reference as a function of time."""
    return 0.6 * math.sin(9.0 * stamp / NS)


def by_law(scenario: Scenario) -> list:
    law = ControlLaw(lambda sample, target, memory, gains: (wish(sample.stamp_ns), memory))
    plant, controller = sides(scenario, law)
    return [entry for messages in exchange(plant, controller, scenario.ticks) for entry in entries_of(messages)]


def by_steps(scenario: Scenario) -> list:
    loop = SteppedLoop(scenario, lean=False)
    messages = [message for out in loop.start() for message in out]
    while not loop.over:
        messages += [message for out in loop.advance(wish(loop.plant.now)) for message in out]
    return entries_of(messages + loop.finish())


def topic(entries: list, name: str) -> list:
    return [entry for entry in entries if entry.topic == name]


TIMELINE = (
    'timeline=[{set="rig.load.force", at="5 ms", to="4 kN"}, {set="reference", when="position > 101 mm", to="0.13 m"}]'
)


@pytest.mark.parametrize(
    "changes",
    [
        ["loop.delay=5 ms"],
        ["loop.delay=0", "loop.offset=13 ms", TIMELINE],
        ["loop.delay=23 ms", "loop.sample_period=7 ms", "controller.velocity=backward", "daq.tachometer=false"],
    ],
)
def test_commands_given_from_outside_make_the_bytes_of_a_law(changes: list[str]):
    """All but the answer to a sample at the very end, which acts on nothing: nobody was asked for it."""
    scenario = load("step", ["duration=0.21", *changes])
    law, steps = by_law(scenario), by_steps(scenario)
    for name in ("measurement", "state", "event", "joint", "lines", "pressure/p1"):
        assert topic(steps, name) == topic(law, name)
        assert topic(law, name)
    for name in ("command", "reference"):
        given = topic(steps, name)
        assert given
        assert given == topic(law, name)[: len(given)]
        assert all(entry.log_time == round(scenario.duration * NS) for entry in topic(law, name)[len(given) :])


def test_the_true_quantities_are_those_of_the_recorded_state():
    loop = SteppedLoop(load("step", ["duration=0.05"]), lean=False)
    [*_] = loop.start()
    out = [message for messages in loop.advance(0.5) for message in messages]
    state = next(message for message in reversed(out) if message.topic == "state").message
    assert loop.plant.observed.tolist() == [getattr(state, name) for name in OBSERVED]


def test_rigs_of_one_oil_and_one_relief_valve_are_fitted_once():
    """Another load does not change a line, nor the screw of the relief valve."""
    rigs = [load("step", [f"rig.load.mass={mass}"]).rig_values() for mass in (141.0, 142.0)]
    one, other = (build(rig, 50e-6) for rig in rigs)
    assert one.lines is other.lines
    assert one.parts.load != other.parts.load
    assert one.parts.relief == other.parts.relief
    stiffer = build(load("step", ["rig.relief.setting=90 bar"]).rig_values(), 50e-6)
    assert stiffer.lines is one.lines
    assert relief_of(stiffer).pilot.preload > relief_of(one).pilot.preload


def test_circuits_for_one_use_are_not_kept_on_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(circuits, "FOLDER", tmp_path)
    with circuits.in_memory():
        circuits.rest_of(load("step", ["rig.load.mass=143"]))
    assert not [*tmp_path.rglob("*.nbc")]
    circuits.rest_of(load("step", ["rig.load.mass=144"]))
    assert len([*tmp_path.rglob("*.nbc")]) == 2
