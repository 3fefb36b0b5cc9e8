"""The twin's own edge of stability beside the linear theory of its own rig."""

import json
import math

import numpy as np
import pytest
from typer.testing import CliRunner

from bridge.cli.verbs import app
from bridge.processes.options import RunOptions
from bridge.runs.in_process import record_in_process
from bridge.runs.run import run_scenario, shown
from bridge.scenario import ScenarioError, load, names
from bridge.studies.stability.advice import refuse_linear
from bridge.studies.stability.amplitude import loop_of
from bridge.studies.stability.causes import with_causes
from bridge.studies.stability.criterion import crossing_frequency, judge_swing
from bridge.studies.stability.notes import timing_notes
from bridge.studies.stability.probe import critical_gain, stand_of, swing_at
from bridge.studies.stability.rig_loop import (
    RigTiming,
    edge_of,
    margins_of,
)
from bridge.studies.stability.rig_loop import loop_of as loop_of_linear
from bridge.studies.stability.rig_plant import plants
from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.trial import stand, trial
from bridge.wire.messages import Mode
from controller.stability import suggested_gain
from controller.stability.amplitude.edges import swing
from tests.support.warm import DRIVES

SQRT2 = math.sqrt(2.0)


def ideal(interval: float, *causes: str):
    return with_causes(
        load("assumed-rig", [f"loop.sample_period={interval}", "loop.delay=0.0", "loop.command_timeout=9.0"]), causes
    )


@pytest.mark.parametrize("changes", [[], ["loop.sample_period=0.023", "loop.offset=0.007", "loop.delay=0.0311"]])
def test_a_trial_moves_the_piston_as_any_other_run_does(changes, tmp_path):
    """Bit for bit: the same card with its noise, law, hold and plant."""
    scenario = load("step", ["duration=2", "controller.derivative=0.01", *changes])
    trace = trial(scenario, stand(scenario))
    columns = record_in_process(scenario, tmp_path / "a.mcap").columns("state")
    rows = np.searchsorted(columns["stamp"], np.round(trace.time * 1e9).astype(np.int64))
    assert np.array_equal(columns["stamp"][rows] / 1e9, trace.time)
    assert np.array_equal(columns["position"][rows], trace.position)
    assert np.array_equal(columns["spool"][rows], trace.spool)


def test_criterion_tells_growth_from_decay_and_irregular_swings():
    t = np.linspace(0.0, 9.0, 4000)
    for rate, oscillates in ((0.05, True), (0.0, True), (-0.05, False)):
        swing = judge_swing(t, 1e-3 * np.exp(rate * t) * np.sin(8.0 * t), 0.0, 2e-3, exact=True)
        assert swing.oscillates is oscillates
    assert crossing_frequency(t, np.sin(8.0 * t)) == pytest.approx(4.0 / math.pi, rel=1e-3)
    assert not judge_swing(t, 1e-4 * np.sin(8.0 * t), 0.0, 2e-3, exact=False).oscillates  # less than the card can tell


@pytest.mark.parametrize("interval", [0.3, pytest.param(0.5, marks=[pytest.mark.endurance, pytest.mark.timeout(600)])])
def test_the_ideal_twin_begins_to_oscillate_where_its_linearisation_says(interval):
    """Between the edges up and down, which differ by the load's pressure alone; at half the sampling frequency."""
    scenario = ideal(interval)
    timing = RigTiming(interval, 0.0, "measured", 0.0)
    edges = [edge_of(point.plant(), timing, 0.0) for point in plants(scenario).values()]
    found = critical_gain(scenario, edges[0].gain, 5e-4, 0.03)
    mean = 2.0 / sum(1.0 / edge.gain for edge in edges)  # of both gains of the valve
    assert [edge.kind for edge in edges] == ["flip", "flip"]
    assert found.critical == pytest.approx(mean, rel=0.05)
    assert found.frequency == pytest.approx(0.5 / interval, rel=0.02)


def test_with_a_leak_the_small_swing_is_that_about_rest():
    """The opening that feeds the leak damps the load: the edge moves from the resonance's to a flip."""
    without, leaking = ideal(0.05), ideal(0.05, "leak")
    timing = RigTiming(0.05, 0.0, "measured", 0.0)
    assert set(plants(without)) == {"up", "down"}
    edge = edge_of(plants(leaking)["rest"].plant(), timing, 0.0)
    assert edge.kind == "flip"
    assert edge.gain > 2.0 * edge_of(plants(without)["up"].plant(), timing, 0.0).gain
    on = stand_of(leaking)
    assert swing_at(leaking, 1.15 * edge.gain, 2e-4, on).oscillates
    assert not swing_at(leaking, 0.85 * edge.gain, 2e-4, on).oscillates


def test_causes_are_named():
    with pytest.raises(ValueError, match=r"cause 'wear' is unknown \(valid: overlap, friction"):
        with_causes(load("step"), ["wear"])


def known(name: str) -> bool:
    """Does the theory know the loop of a built-in scenario?"""
    try:
        refuse_linear(load(name))
    except ScenarioError:
        return False
    return True


def test_every_loop_of_a_built_in_scenario_is_known_or_not_a_pd():
    """Of the thesis's rig; the loops of the other drives are all PD."""
    of_the_rig = set(names()) - set(DRIVES)
    found = set(filter(known, of_the_rig))
    assert found == {"assumed-rig", "delay", "sine", "slow-sampling", "square", "step"}
    for name in of_the_rig - found:
        assert load(name).controller.kind != "pd"


def test_a_delay_without_its_unit_is_answered_and_named():
    notes = timing_notes(load("step", ["loop.delay=10"]))
    assert notes == ["loop.delay is 10 s, 1000 sampling periods: a unit may be missing, as in '10 ms'"]
    with pytest.raises(ValueError, match="beyond this theory, which ends at 100"):
        loop_of_linear(plants(load("step"))["up"].plant(), RigTiming(0.01, 10.0, "measured", 0.0))


def test_suggested_gains_keep_their_margins():
    scenario = load("slow-sampling")
    timing, found = RigTiming(0.1, 0.0, "measured", 0.0), [point.plant() for point in plants(scenario).values()]
    gain = suggested_gain(found, 0.0, timing.counted())
    kept = [margins_of(plant, timing, gain, 0.0) for plant in found]
    assert min(m.gain_margin for m in kept) >= 2.0
    assert min(m.delay_margin for m in kept) >= 1.0


def test_summary_places_the_run_and_compares_frequencies(tmp_path):
    scenario = load("slow-sampling", ["duration=5"])
    outcome = run_scenario(scenario, RunOptions(Mode.INPROCESS, tmp_path / "a.mcap"))
    assert "stability" not in outcome.plain()  # computed when somebody looks
    assert not (tmp_path / "a.png").exists()
    outcome = shown(outcome)
    assert outcome.picture == tmp_path / "a.png"
    assert (tmp_path / "a.png").exists()
    at = outcome.plain()["stability"]
    assert at["verdict"] == "unstable"
    assert len(at["swings_after"]) == 6
    assert at["found_frequency"] == pytest.approx(5.0, rel=0.01)
    assert at["predicted_frequency"] == pytest.approx(5.0, rel=0.05)
    options = RunOptions(Mode.INPROCESS, tmp_path / "b.mcap")
    assert shown(run_scenario(load("hold-load", ["duration=1"]), options)).plain()["stability"] is None


@pytest.mark.parametrize(("derivative", "oscillates"), [("0.0 V s/%", False), ("0.03 V s/%", True)])
def test_a_derivative_gain_destabilises_a_stable_loop(derivative, oscillates, tmp_path):
    """hydrotwin run slow-sampling --set controller.gain=0.5 --set controller.derivative=0.03

    Without the card's noise and steps: these make the piston hop by tenths of a millimetre in a stable loop, too.
    """
    card = ["daq.noise=0", "daq.quantise=false", "daq.quantise_output=false", "daq.skew=0"]
    gains = ["controller.gain=0.5", f"controller.derivative={derivative}"]
    scenario = load("slow-sampling", [*gains, *card, "duration=5"])
    outcome = run_scenario(scenario, RunOptions(Mode.INPROCESS, tmp_path / "a.mcap"))
    found = outcome.plain()["metrics"]["limit_cycle_frequency"]
    assert found == pytest.approx(5.0 if oscillates else 0.0, abs=0.1)
    own = swing(loop_of(scenario), free_gain(scenario).own, 60e-3)
    assert (own.peak_to_peak > 2e-3) is oscillates


def test_map_writes_picture_table_and_a_page_without_addresses(tmp_path):
    words = ["map", "period", "gain", "--rig", "slow-sampling", "--x", "80:200", "--y", "0.05:2", "--cells", "8"]
    done = CliRunner().invoke(app, [*words, "--runs", "3", "--workers", "1", "-o", str(tmp_path / "m"), "--json"])
    assert done.exit_code == 0, done.output
    assert [path.rpartition(".")[2] for path in json.loads(done.stdout)] == [
        "png",
        "csv",
        "html",
        "csv",
    ]
    page = (tmp_path / "m.html").read_text()
    assert "http" not in page
    assert "<canvas" in page
    assert len((tmp_path / "m.csv").read_text().splitlines()) == 1 + 64
    runs = np.loadtxt(tmp_path / "m-runs.csv", delimiter=",", skiprows=1)
    assert {0.0, 1.0} == set(runs[:, 2])
