"""Faults of the plant: each is there in its window alone, is what its name says, and keeps the oil."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from bridge.loop.exchange import exchange, sides
from bridge.recording.manifest import manifest
from bridge.recording.reader import Recording, recording
from bridge.recording.writer import entries_of
from bridge.runs.in_process import run_in_memory
from bridge.scenario import Scenario, load
from bridge.scenario.fault_kinds import PLANT
from bridge.scenario.tunable import tunables
from controller.grid import NS
from tests.support.faults import BAR, BEGIN, END, faulty, one

RIG_KINDS: dict[tuple[str, str], tuple[str, str, Callable[[float], float]]] = {  # sizes, a number, what becomes of it
    ("pump", "speed-drop"): ("factor=0.6", "rig.pump.speed", lambda v: 0.6 * v),
    ("pump", "stop"): ("over=0", "rig.pump.speed", lambda v: 0.0),
    ("pump", "wear"): ("factor=2", "rig.pump.efficiency", lambda v: 1.0 - 2.0 * (1.0 - v)),
    ("oil", "temperature"): ('to="55 degC"', "rig.oil.temperature", lambda v: 55.0),
    ("oil", "air"): ("factor=0.4", "rig.cylinder.stiffness", lambda v: 0.4),
    ("cylinder", "leak"): ("factor=50", "rig.cylinder.leakage_resistance", lambda v: v / 50.0),
    ("cylinder", "seal-wear"): ("friction=0.5", "rig.seal.diameter", lambda v: 0.5 * v),
    ("pipe_3", "burst"): ('diameter="1 mm"', "rig.cylinder.hole_lower", lambda v: 1e-3),
    ("pipe_4", "burst"): ('diameter="1 mm"', "rig.cylinder.hole_upper", lambda v: 1e-3),
    ("filter", "blocked"): ("factor=20", "rig.filter.drop", lambda v: 20.0 * v),
    ("relief", "stuck-open"): ("", "rig.relief.pilot_stiffness", lambda v: 0.01 * v),
    ("relief", "stuck-shut"): ("", "rig.relief.setting", lambda v: 10.0 * v),
    ("relief", "setting"): ('to="40 bar"', "rig.relief.setting", lambda v: 40 * BAR),
    ("load", "jump"): ('mass="60 kg", force="-300 N"', "rig.load.mass", lambda v: v + 60.0),
    ("load", "lost"): ("factor=0.5", "rig.load.mass", lambda v: 0.5 * v),
    ("load", "impact"): ('impulse="60 N s"', "rig.load.force", lambda v: v + 60.0 / (END - BEGIN)),
}


def test_every_kind_of_fault_of_the_plant_has_its_test():
    kinds = {(target, kind) for target, of_target in PLANT.items() for kind in of_target if target != "valve"}
    assert {*RIG_KINDS} == kinds


def driven(made: Scenario) -> tuple[Recording, list[dict[str, float]]]:
    """A run, and what the rig's numbers are at each tick."""
    plant, controller = sides(made)
    entries, numbers = [], []
    for messages in exchange(plant, controller, made.ticks):
        entries += entries_of(messages)
        numbers.append({name: value for name, (_, value) in plant.values().items() if name.startswith("rig.")})
    return recording(Path("memory"), entries, {"run": manifest(made, plant.run_id)}), numbers


@pytest.mark.parametrize(("target", "kind"), RIG_KINDS, ids=lambda word: word)
def test_a_fault_of_the_plant_changes_its_number_and_the_state_and_keeps_the_oil(target: str, kind: str):
    """Before it all is as without it, to the bit; after it the number is what it was; the books hold to 1e-12."""
    sizes, name, becomes = RIG_KINDS[target, kind]
    lumped = tuple(f"rig.pipe_{i}.model=lumped" for i in range(1, 7))
    made = faulty(one(target, kind, sizes), changes=lumped, duration=0.6)
    run, numbers = driven(made)
    own = tunables(made)[name].value
    found = np.array([values[name] for values in numbers])
    t = np.arange(len(found)) * 1e-3
    inside = (t > BEGIN - 1e-6) & (t < END - 1e-6)
    assert found[inside] == pytest.approx(becomes(own), rel=1e-12)
    assert (found[~inside] == own).all()
    state = run.columns("state")
    quiet = run_in_memory(faulty(changes=(*lumped, f"rig.cylinder.holes={_holes(target)}"), duration=0.6)).columns(
        "state"
    )
    same = [name for name in ("position", "p_lower", "p_upper", "p_tee", "spool") if name in state]
    before = t < BEGIN + 1e-6
    assert all((state[name][before] == quiet[name][before]).all() for name in same)
    assert any((state[name][~before] != quiet[name][~before]).any() for name in same)
    crossed = state["oil_pumped"] - state["oil_relieved"] - state["oil_returned"]
    stored = state["oil_stored"]
    assert np.abs(stored - stored[0] - (crossed - crossed[0])).max() < 1e-12 * stored[0]


def _holes(target: str) -> str:
    return "fitted" if target in ("pipe_3", "pipe_4") else "none"


def test_a_burst_lets_out_what_torricelli_says():
    """Of the books: what left besides the return line, against c A sqrt(2 p/rho) of the chamber's pressure."""
    fault = one("pipe_3", "burst", 'diameter="1 mm"')
    still = ("reference.at=9", "controller.gain=0 V/%", "rig.cylinder.hole_transition=0")
    lumped = (f"rig.pipe_{i}.model=lumped" for i in range(1, 7))
    made = load("step", [f"fault=[{fault}]", *still, *lumped, "duration=0.5", "expect=[]"])
    state = run_in_memory(made).columns("state")
    within = (state["stamp"] > BEGIN * NS) & (state["stamp"] < END * NS)
    t = state["stamp"][within] / NS
    flow = 0.61 * 0.25 * math.pi * 1e-6 * np.sqrt(2.0 * np.maximum(state["p_lower"][within], 0.0) / 878.0)
    left = np.ptp(state["oil_returned"][within]) - np.trapezoid(state["flow_6"][within], t)
    assert left == pytest.approx(np.trapezoid(flow, t), rel=0.02)
    assert state["position"][within][0] - state["position"][within][-1] > 1e-3  # and the load sinks


def test_an_impact_gives_its_impulse():
    """m v = the impulse, on a load that slides freely."""
    free = ("rig.friction.kind=none", "reference.at=9", "controller.gain=0 V/%", "rig.cylinder.stiffness=1e-3")
    blow = '{target="load", kind="impact", impulse="12 N s", at="0.1 s", lasts="1 ms"}'
    state = run_in_memory(load("step", [f"fault=[{blow}]", *free, "duration=0.12", "expect=[]"])).columns("state")
    quiet = run_in_memory(load("step", [*free, "duration=0.12", "expect=[]"])).columns("state")
    gained = state["velocity"][101] - quiet["velocity"][101]
    assert gained == pytest.approx(12.0 / 120.0, rel=0.02)
