"""A user's other rigs, by scenario alone: each runs in process, for real, and obeys what must hold for it."""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.scenario.circuit import circuit_of
from controller.grid import NS
from tests.support.plant import BAR, Array
from twin.circuit.reading import force_balance, speed_balance
from twin.circuit.step import Circuit
from twin.rig import values

OPEN_LOOP = ["controller.kind=open-loop", "loop.sample_period='1 ms'"]
SWITCHING = "rig.valve.kind=switching"
UP = [(0.0, 0.0), (0.1, 0.0), (0.101, 1.0)]
DOWN = [(0.0, 0.0), (0.1, 0.0), (0.101, -1.0)]
LITRE_PER_MINUTE = 1e-3 / 60.0


def models(model: str) -> list[str]:
    return [f"rig.pipe_{number}.model={model}" for number in range(1, 7)]


def given(points: list[tuple[float, float]]) -> str:
    """The spool reference of an open loop."""
    rows = "\n".join(f"{at},{value}" for at, value in points)
    return f"reference={{kind='table', csv='''time_s,position_m\n{rows}\n'''}}"


class Ran(NamedTuple):
    """A run that is over."""

    time: Array
    seen: dict[str, Array]
    circuit: Circuit

    def mean(self, name: str, begin: float, end: float) -> float:
        return float(self.seen[name][(self.time >= begin) & (self.time <= end)].mean())

    def balance(self, law, begin: float, end: float) -> float:
        values = law(self.time, self.seen, self.circuit)
        return float(values[(self.time >= begin) & (self.time <= end)].mean())


@pytest.fixture
def ran(tmp_path: Path):
    """Run a scenario with changes and keep its books: no pressure below vapour, no oil lost."""

    def at(*changes: str) -> Ran:
        scenario = load("step", [*OPEN_LOOP, *changes])
        seen = record_in_process(scenario, tmp_path / "run.mcap").columns("state")
        assert min(seen[name].min() for name in seen if name.startswith("p_") or name == "p1") >= -BAR
        crossed = seen["oil_pumped"] - seen["oil_relieved"] - seen["oil_returned"]
        assert seen["oil_stored"] - seen["oil_stored"][0] == pytest.approx(crossed, abs=1e-12 * seen["oil_stored"][0])
        return Ran(seen["stamp"] / NS, seen, circuit_of(scenario))

    return at


def test_without_a_relief_valve_the_pump_leaks_all_it_gives(ran):
    """At rest the pressure at which its efficiency is 0: 320 bar, with ripple to 1 %; rising, the piston takes what
    the pump gives."""
    pump = values()["pump"]
    dead = pump["efficiency_pressure"] / (1.0 - pump["efficiency"])
    r = ran("rig.relief.kind=none", "duration='0.7 s'", "rig.cylinder.leakage_resistance=inf", given(UP))
    assert r.mean("p1", 0.0, 0.1) == pytest.approx(dead, rel=0.01)
    assert not r.seen["flow_relief"].any()
    assert abs(r.balance(speed_balance, 0.35, 0.5)) < 0.01 * r.mean("velocity", 0.35, 0.5)
    assert r.mean("p1", 0.35, 0.5) < 60 * BAR


def test_a_switching_valve_under_a_relay_hunts_about_its_target(ran):
    """The spool needs its time out and back, so loop and piston swing; their mean is the target to 5 mm."""
    valve = values()["switching_valve"]
    step = "reference={kind='step', start=0.1, end=0.16, at=0.1}"
    r = ran(SWITCHING, "controller.kind=relay", step, "duration='1 s'")
    spool, out, back = r.seen["spool"], 1.0 / valve["switching_time"], 1.0 / valve["return_time"]
    crossing = 50e-6  # [s], the step that passes the centre, at the speed of its begin
    assert np.diff(np.abs(spool)).max() <= (1e-3 - crossing) * out + crossing * back + 1e-9
    assert np.abs(np.diff(spool)).max() <= 1e-3 * back + 1e-9
    assert {r.seen["spool"].min(), r.seen["spool"].max()} == {-1.0, 1.0}
    assert r.mean("position", 0.5, 1.0) == pytest.approx(0.16, abs=5e-3)
    assert np.ptp(r.seen["position"][500:]) > 5e-3


def test_lumped_lines_move_the_load_as_lines_with_waves_do(ran):
    """Settled, speed and pressures are those of the flow, not of the waves: 1 %, with ripple in both."""
    waves, lumped = (ran(*models(model), "duration='0.6 s'", given(UP)) for model in ("ends", "lumped"))
    for name in ("velocity", "p1", "p_lower", "p_upper"):
        assert lumped.mean(name, 0.35, 0.5) == pytest.approx(waves.mean(name, 0.35, 0.5), rel=0.01)


def test_longer_lines_cost_their_laminar_drop(ran):
    """Poiseuille, 128 mu l Q/(pi d^4), of 3 m where the rig has 1.25 m: 2 %, a window of ripple; the force balances.

    Re is 1300 in the line from the pump; its elbows are left out.
    """
    lengths = ["rig.pipe_1.length='3 m'", "rig.pipe_3.length='5 m'", "rig.pipe_6.length='0.6 m'"]
    r = ran(*lengths, "rig.minor_losses.pipe_1=0", "duration='0.6 s'", given(UP))
    flow = r.mean("flow_1", 0.35, 0.5)
    assert 20 * LITRE_PER_MINUTE < flow < 27 * LITRE_PER_MINUTE
    drop = r.mean("p_pump", 0.35, 0.5) - r.mean("p1", 0.35, 0.5)
    assert drop == pytest.approx(128.0 * 878.0 * 40e-6 * 3.0 * flow / (math.pi * 0.011**4), rel=0.02)
    assert abs(r.balance(force_balance, 0.35, 0.5)) < 0.1 * BAR


def test_lines_with_nodes_cavitate_inside(ran):
    """A heavy load thrown down and stopped: vapour inside lines, less than the lines hold; none before."""
    stop = [*DOWN, (0.4, -1.0), (0.401, 0.0)]
    heavy = ["rig.load.mass='303 kg'", "start.position='0.2 m'", "rig.cylinder.leakage_resistance=inf"]
    r = ran(*models("nodes"), SWITCHING, *heavy, "rig.pump.ripple=none", "duration='0.7 s'", given(stop))
    assert not r.seen["cavity_lines"][:100].any()
    assert 1e-7 < r.seen["cavity_lines"].max() < r.circuit.parts.line_volume


def test_a_weight_carried_from_the_start_is_set_down_on_its_support(ran):
    """303 kg above 138 mm, 120 kg below; p_lower at the start carries both, m g/A_l."""
    r = ran(SWITCHING, "rig.load.added='183 kg'", "start.position='0.2 m'", "duration='0.8 s'", given(DOWN))
    above = r.seen["position"] >= 0.138
    assert r.seen["mass"][above] == pytest.approx(303.0)
    assert r.seen["mass"][~above] == pytest.approx(120.0)
    assert 0 < (~above).sum() < above.size
    area = r.circuit.parts.cylinder.area_lower
    assert r.seen["p_lower"][0] == pytest.approx(303.0 * 9.81 / area, rel=1e-9)


def test_the_pump_runs_up_to_the_setting_of_the_relief_valve(ran):
    """Nothing at the start; from then 67 bar at 26.7 l/min is its setting. At rest it passes 24 l/min at 66 to 68 bar,
    all that the pump gives there; oil pumped until full speed is half of that time's."""
    r = ran("rig.pump.run_up='300 ms'", "duration='1 s'", given([(0.0, 0.0), (1.0, 0.0)]))
    assert r.seen["p1"][0] == 0.0
    assert r.mean("p1", 0.6, 1.0) == pytest.approx(67 * BAR, rel=0.02)
    assert r.mean("flow_relief", 0.6, 1.0) == pytest.approx(r.mean("flow_pump", 0.6, 1.0), rel=0.01)
    pump = r.circuit.parts.supply
    leaked = pump.leakage * r.mean("p_pump", 0.0, 0.3) * 0.3
    assert np.interp(0.3, r.time, r.seen["oil_pumped"]) == pytest.approx(0.5 * 0.3 * pump.delivery - leaked, rel=0.02)
