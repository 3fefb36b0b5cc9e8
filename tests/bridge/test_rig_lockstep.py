"""Edges of stability found in process, confirmed by three processes over Zenoh in lockstep."""

from pathlib import Path

import numpy as np
import pytest

from bridge.processes.options import RunOptions
from bridge.recording.reader import read
from bridge.runs.run import run_scenario
from bridge.scenario import Scenario, load
from bridge.studies.stability.criterion import Swing
from bridge.studies.stability.probe import (
    critical_gain,
    judged,
    probe,
    stand_of,
)
from bridge.studies.stability.rig_loop import edge_of, timing_of
from bridge.studies.stability.rig_plant import at_rest, plants
from bridge.studies.stability.trial import Trace, trial
from bridge.wire.messages import Mode
from controller.law import per_metre

SIZE = 20e-3  # [m], a step of figure 5.21


def rig(interval: float, delay: float) -> Scenario:
    times = {"sample_period": interval, "delay": delay, "command_timeout": 12.0 * interval}
    return at_rest(load("step", [f"loop.{name}={value!r}" for name, value in times.items()]))


def through_the_wire(asked: Scenario, file: Path) -> Trace:
    """The true course of a run in lockstep, a row a tick."""
    outcome = run_scenario(asked, RunOptions(Mode.LOCKSTEP, file, patience=20.0))
    assert not outcome.faults
    columns = read(file, ("state",)).columns("state")
    return Trace(columns["stamp"] / 1e9, columns["position"], columns["spool"])


def both_ways(asked: Scenario, file: Path) -> Swing:
    """The swing in lockstep, which is the one in process bit for bit."""
    wired, alone = through_the_wire(asked, file), trial(asked, stand_of(asked))
    rows = np.searchsorted(wired.time, alone.time)
    for there, here in zip(wired, alone, strict=True):
        np.testing.assert_array_equal(there[rows], here)
    return judged(alone, asked, SIZE)


def test_a_run_beyond_the_edge_is_the_same_through_the_wire(tmp_path: Path):
    """Sampled every 100 ms, 30 ms late, at 1.3 times the greatest critical gain of the theory: 4 s."""
    scenario = rig(0.1, 0.03)
    theory = [edge_of(point.plant(), timing_of(scenario), 0.0).gain for point in plants(scenario).values()]
    asked = probe(scenario, 1.3 * max(theory), SIZE).model_copy(update={"duration": 4.0})
    assert both_ways(asked, tmp_path / "a.mcap").oscillates


@pytest.mark.endurance
@pytest.mark.timeout(900)
@pytest.mark.parametrize(
    ("interval", "delay", "guess"),
    [(0.05, 0.0, 1.2), (0.1, 0.0, 0.73), (0.2, 0.0, 0.49), (0.5, 0.0, 0.19), (0.1, 0.06, 0.5), (0.1, 0.15, 0.35)],
)
def test_six_edges_found_in_process_are_edges_in_lockstep(interval: float, delay: float, guess: float, tmp_path: Path):
    """At the two gains between which the edge was found, 3 % apart; guesses in V/%."""
    scenario = rig(interval, delay)
    edge = critical_gain(scenario, per_metre(guess, 0.27, 10.0), SIZE, 0.03)
    quiet, loud = (
        both_ways(probe(scenario, gain, SIZE), tmp_path / f"{gain}.mcap") for gain in (edge.stable, edge.unstable)
    )
    assert (quiet.oscillates, loud.oscillates) == (False, True)
    assert loud.frequency == edge.frequency
    print(f"{interval} s, delay {delay} s: {edge.stable * 0.027:.3f} to {edge.unstable * 0.027:.3f} V/%, ", end="")
    print(f"{edge.frequency:.3g} Hz, {edge.frequency * 2.0 * interval:.2f} of half the sampling frequency")
