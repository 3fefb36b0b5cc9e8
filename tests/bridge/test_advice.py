"""Advice on a scenario's gains: beside the twin, of any law, of a relay, and in the summary of a run."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter
from typer.testing import CliRunner

from bridge.cli.printing import print_summary
from bridge.cli.verbs import app
from bridge.errors import RunError
from bridge.loop.law import law_of
from bridge.processes.options import RunOptions
from bridge.runs.check import check_scenario
from bridge.runs.run import run_scenario, shown
from bridge.scenario import Scenario, ScenarioError, load
from bridge.scenario.gains import law_gains
from bridge.studies.stability import amplitude, twin_range
from bridge.studies.stability.advice import advise
from bridge.studies.stability.advised import Advice, CycleAdvice
from bridge.studies.stability.amplitude import loop_of, scans_of
from bridge.studies.stability.probe import stand_of
from bridge.studies.stability.sampled_law import free_gain, is_system
from bridge.studies.stability.search import WORK
from bridge.studies.stability.trial import trial
from bridge.studies.stability.twin_edge import SCAN, step_edge, stepped, twin_swing
from bridge.studies.stability.twin_loop import runs_alone
from bridge.studies.stability.twin_range import search_of
from bridge.studies.stability.verified import VerifiedCycle
from bridge.wire.messages import Mode
from controller.law import Sample
from controller.reference import Target
from controller.stability.amplitude.edges import SEEDS, swing
from controller.stability.amplitude.swing import Swing, last_third

SQRT2 = math.sqrt(2.0)


LONG = (pytest.mark.endurance, pytest.mark.timeout(300))


def fewer_motions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only the steps that are asked for, with one noise."""
    for steps_and_noises, fewer in (("FURTHER", ()), ("ASKED", ()), ("SEEDS", SEEDS[:1])):
        monkeypatch.setattr(amplitude, steps_and_noises, fewer)


@pytest.mark.parametrize(
    ("name", "work"), [*(pytest.param(name, WORK, marks=LONG) for name in ("delay", "slow-sampling")), ("step", 0.0)]
)
def test_advice_agrees_with_what_check_finds(name, work, tmp_path, monkeypatch):
    """What the own gain does needs no search: without any time for one its row is still that of a run of the twin."""
    monkeypatch.setattr(twin_range, "WORK", work)
    fewer_motions(monkeypatch)
    scenario = load(name, ["duration=6"])
    advice, outcome = advise(scenario, (60e-3,)), check_scenario(scenario, Mode.INPROCESS, tmp_path)
    swings = [verdict for verdict in outcome.verdicts if "limit cycle" in verdict.text]
    assert outcome.passed
    assert isinstance(advice, Advice)
    own = next(row for row in advice.rows if row.gain == advice.gain)
    if name == "step":
        assert own.peak_to_peak < 2e-3
        assert all("limit cycle: present" not in verdict.text for verdict in swings)
    else:
        found = float(swings[0].found.partition(" at ")[2].split()[0])
        assert 60e-3 in own.swings_after  # the scenario's own step
        assert own.frequency == pytest.approx(found, rel=0.2)


EDGES = [  # sampling period [ms], delay [ms], mass [kg], step [mm]
    pytest.param(50, 25, 303, -2, marks=LONG),
    (50, 200, 120, 20),
]


@pytest.mark.parametrize(("period", "delay", "mass", "size"), EDGES)
def test_the_edge_of_the_twin_lies_in_the_interval(period, delay, mass, size):
    """A search for the edge at other gains than those of the scan ends in its interval. All: tests.benchmarks."""
    times = [f"loop.sample_period={period}ms", f"loop.delay={delay}ms", "loop.command_timeout=1"]
    scenario = load("step", [*times, f"rig.load.mass={mass}"])
    (found,) = scans_of(scenario, loop_of(scenario), search_of(scenario, [size * 1e-3]))
    edge = step_edge(scenario, size * 1e-3, 0.7 * found.low, SCAN._replace(ratio=1.25))
    assert found.high <= 2.001 * found.low
    assert found.low <= edge.swings
    assert edge.settles <= found.high


def test_a_law_of_the_users_runs_itself_and_its_free_gain_is_what_it_minds(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text(
        "def minds(sample, target, memory, gains):\n"
        "    return gains.proportional * (target.position - sample.position), None\n"
        "def stubborn(sample, target, memory, gains):\n"
        "    return 20.0 * (target.position - sample.position), None\n"
    )
    exact = ["daq.noise=0", "daq.quantise=false"]
    loops = ["loop.sample_period=100ms", "loop.command_timeout=1", "controller.kind=python", *exact]
    minds, stubborn = (load("step", [*loops, f"controller.law=mine.py:{name}"]) for name in ("minds", "stubborn"))
    pd = load("step", [*loops[:2], *exact, "controller.compensate_overlap=false"])
    assert free_gain(minds).unit == "V/%"
    assert free_gain(stubborn) == (1.0, "x", 1.0)
    often = load("step", ["controller.kind=python", "controller.law=mine.py:minds", "loop.sample_period=5ms"])
    assert [runs_alone(scenario) for scenario in (minds, often)] == [False, True]
    own = free_gain(pd).own
    expected = swing(loop_of(pd), 8.0 * own, 0.02)
    for scenario, gain in ((minds, 8.0 * own), (stubborn, 8.0 * own / 20.0)):
        found = swing(loop_of(scenario), gain, 0.02)
        assert found.counts
        assert found.frequency == pytest.approx(expected.frequency, rel=0.1)


def test_a_relay_has_a_cycle_and_no_gain():
    """The twin swings as wide and as often as the reduced drive."""
    scenario = load("step", ["controller={kind='relay', limit=0.3}", "loop.sample_period=5ms", "loop.delay=0"])
    found = advise(scenario, (20e-3,))
    assert isinstance(found, CycleAdvice)
    assert found.verdict == "unstable"
    trace = trial(stepped(scenario, 20e-3), stand_of(scenario))
    twin = last_third(trace.time, trace.position)
    size, peak, frequency = found.cycles[0]
    assert size == 20e-3
    assert peak == pytest.approx(twin.peak_to_peak, rel=0.25)
    assert frequency == pytest.approx(twin.frequency, rel=0.1)


@pytest.mark.parametrize("mass", [120, 303])
def test_a_little_of_the_overlap_left_stops_the_hunting_for_a_small_error(mass):
    """4 % of an overlap of 10 % left over a gain of 37/m: a dead band of +-0.11 mm, more than a step of the card.

    Whether a run hunts is a matter of its noise: of six, several fewer do.
    """
    at_rest, hunting = {}, {}
    for share in (1.0, 0.96):
        scenario = load("step", [f"rig.load.mass={mass}", f"controller.overlap_share={share}"])
        late = [late_half(scenario.model_copy(update={"seed": seed})) for seed in range(1, 7)]
        hunting[share] = sum(np.ptp(position) > 0.1e-3 for position in late)
        at_rest[share] = [np.abs(position - 0.12).max() for position in late if np.ptp(position) < 0.1e-3]
    left = 0.04 * scenario.rig.valve.overlap / free_gain(scenario).own
    assert left > scenario.daq.position_range / 2**scenario.daq.bits
    assert hunting[1.0] >= hunting[0.96] + 2
    assert max(at_rest[0.96]) < left + 0.05e-3


def late_half(scenario: Scenario) -> np.ndarray:
    """True position [m] from 4 s to 8 s, after a step of 20 mm at 1 s."""
    asked = stepped(scenario, 20e-3).model_copy(update={"duration": 8.0})
    trace = trial(asked, stand_of(asked))
    return trace.position[trace.time > 4.0]


LATE = ("--set", "loop.delay=10ms", "--set", "controller.derivative_time=0")  # where both valves have a frequency


@pytest.mark.parametrize("valve", ["proportional", "switching"])
def test_advice_on_a_relay_is_checked_against_runs_of_the_twin(valve):
    words = ["advise", "relay", "--set", f"rig.valve.kind={valve}", *LATE, "--step", "20mm"]
    found = json.loads(CliRunner().invoke(app, [*words, "--verify", "--json"]).stdout)
    assert found["verdict"] == "unstable"
    assert found["needed_lead"] - found["critical_lead"] == pytest.approx(0.01 + 0.5 * 0.005)
    assert [run["agrees"] for run in found["verified"]] == [True, True]
    assert [run["peak_to_peak"] for run in found["verified"]] == [cycle["peak_to_peak"] for cycle in found["cycles"]]
    table = CliRunner().invoke(app, [*words, "--verify"]).stdout
    assert table.count("agrees") == 2


def test_a_cycle_that_is_not_the_twins_disagrees():
    run = VerifiedCycle(20e-3, 10e-3, 10.0, Swing(12e-3, 11.0))
    assert run.agrees
    assert not run._replace(peak_to_peak=20e-3).agrees
    assert not run._replace(frequency=14.0).agrees
    assert run._replace(frequency=0.0).agrees


@pytest.mark.parametrize("kind", ["python", "relay"])
def test_a_summary_says_where_advice_on_its_law_is(kind, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text("def law(sample, target, memory, gains):\n    return 0.0, None\n")
    law = (
        ["controller.law=mine.py:law", "controller.kind=python"] if kind == "python" else ["controller={kind='relay'}"]
    )
    outcome = shown(run_scenario(load("step", ["duration=0.3", *law]), RunOptions(Mode.INPROCESS, tmp_path / "a.mcap")))
    print_summary(outcome)
    assert "hydrotwin advise" in capsys.readouterr().out


def test_a_loop_that_no_gain_makes_swing_settles_and_has_no_gain_to_suggest(monkeypatch):
    """The spool stays within the overlap of its lands, so the piston only sinks by its leak."""
    fewer_motions(monkeypatch)
    found = advise(load("step", ["controller.compensate_overlap=false", "controller.limit=0.05"]), (20e-3,))
    assert isinstance(found, Advice)
    assert found.verdict == "stable"
    gains = (found.settles_below, found.swings_above, found.wide_above, found.suggested.gain, found.suggested.patient)
    assert {gain.volts for gain in gains} == {None}
    assert not found.rows


def test_loops_without_theory_are_refused():
    with pytest.raises(ScenarioError, match=r"set controller\.kind = 'pd'"):
        advise(load("hold-load"))


def test_a_control_system_is_a_law(tmp_path, monkeypatch):
    """A gain of 1 is P; a lag has the state that scipy's difference equation has."""
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text(
        "import control\n"
        "one = control.ss([], [], [], [[1.0]], 0.1)\n"
        "lag = control.tf([0.3], [1.0, -0.7], 0.1)\n"
        "analogue = control.tf([1.0], [1.0, 1.0])\n"
    )
    loops = ["loop.sample_period=100ms", "loop.command_timeout=1", "controller.kind=python"]
    one, lag = (load("step", [*loops, f"controller.law=mine.py:{name}"]) for name in ("one", "lag"))
    pd = load("step", loops[:2])
    assert is_system(one)
    assert np.array_equal(trial(one, stand_of(one)).position, trial(pd, stand_of(pd)).position)
    law = law_of(lag.controller)
    own: Any = law_gains(lag)
    memory, found = None, []
    for k in range(20):
        spool, memory, *_ = law.answer(Sample(k, 0.0, 0.0, 0.0, 0.0, 0.0), Target(1e-3, 0.0), memory, own)
        found.append(spool)
    steady = np.asarray(lfilter([0.0, 0.3], [1.0, -0.7], np.full(20, 1e-3))) * own.proportional
    assert found == pytest.approx(np.sign(steady) * (own.overlap + (1.0 - own.overlap) * steady))
    own_gain = free_gain(lag).own
    ours, twin = swing(loop_of(lag), 5.0 * own_gain, 0.02), twin_swing(lag, 5.0 * own_gain, 0.02)
    assert ours.counts
    assert ours.frequency == pytest.approx(twin.frequency, rel=0.2)
    with pytest.raises(ScenarioError, match="give the sampling period in seconds"):
        trial(load("step", [*loops, "controller.law=mine.py:analogue"]), stand_of(pd))
    with pytest.raises(RunError, match=r"has dt 0\.1 s, loop\.sample_period is 0\.05 s"):
        trial(load("step", ["loop.sample_period=50ms", loops[2], "controller.law=mine.py:one"]), stand_of(pd))
