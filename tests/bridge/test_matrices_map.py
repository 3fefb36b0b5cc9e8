"""Charts of a loop under a law given as matrices: each cell is the loop of its own numbers."""

from pathlib import Path
from typing import Any

import control
import numpy as np
import pytest

from bridge.scenario import Scenario, load
from bridge.scenario.gains import scale_of
from bridge.studies.linear_model import sampled_model
from bridge.studies.stability.chart import OfRig, chart
from bridge.studies.stability.matrices_chart import OfMatrices
from bridge.studies.stability.probe import probe
from tests.support.command import hydrotwin_here
from twin.circuit.linear import INPUTS, TAPS

SLOW = ["loop.sample_period=100ms", "loop.delay=0", "loop.command_timeout=1"]
ONE = scale_of(load("step")).per_metre("1 V/%")


def matrices(*changes: str) -> Scenario:
    own = ["controller.kind=state-space", "controller.dt=100ms"]
    return load("step", [*SLOW, *own, *(f"controller.{change}" for change in changes)])


def test_error_and_velocity_make_the_chart_of_the_pd_controller():
    """A factor on P = 1 V/% and D = 0.05 V s/% is both gains."""
    pd = OfRig(load("step", [*SLOW, "controller.derivative=0.05 V s/%"]), "up")
    own = OfMatrices(matrices(f"D=[[{ONE!r}, {-0.05 * ONE!r}]]", "inputs=['error', 'velocity']"), "up")
    delays = np.array([0.0, 40.0, 100.0, 130.0])
    for factor in (0.5, 1.0, 3.0):
        at = {"gain": factor, "derivative": 0.05 * factor}
        pd.numbers |= at
        theirs = chart(pd, "delay", "damping", delays, np.array([0.0, 500.0]))
        own.numbers["gain"] = factor
        ours = chart(own, "delay", "damping", delays, np.array([0.0, 500.0]))
        assert ours.outside.tolist() == theirs.outside.tolist()
        assert ours.excess == pytest.approx(theirs.excess, abs=1e-9)
    assert ours.labels == theirs.labels
    assert "derivative" not in ours.numbers


def test_a_lag_closes_the_loop_that_the_package_control_closes():
    """The largest multiplier of its feedback loop about the sampled plant, with a delay between samples."""
    own = OfMatrices(matrices("A=[[0.7]]", "B=[[1.0]]", "C=[[0.3]]", "D=[[0.1]]"), "up")
    drawn = chart(own, "gain", "delay", np.array([5.0, 50.0]), np.array([0.0, 30.0, 100.0]))
    plant = own.about_point.linear
    entries = np.column_stack([plant.b, np.zeros((len(plant.b), len(INPUTS) - 1))])
    outputs = np.zeros((len(TAPS), len(plant.b)))
    outputs[0] = plant.position
    rig: Any = control.ss(plant.a, entries, outputs, np.zeros((len(TAPS), len(INPUTS))))
    law = control.ss([[0.7]], [[1.0]], [[0.3]], [[0.1]], 0.1)
    for i, delay in enumerate((0.0, 0.03, 0.1)):
        sampled = sampled_model(rig, 0.1, delay)[0, 0]
        for j, factor in enumerate((5.0, 50.0)):
            closed: Any = control.feedback(sampled, factor * law)
            poles = np.abs(closed.poles())
            assert drawn.excess[i, j] == pytest.approx(poles.max() - 1.0, abs=1e-6)
            assert drawn.outside[i, j] == np.sum(poles >= 1.0 + 1e-9)


def test_a_trial_of_the_twin_has_the_factor_on_its_matrices():
    law = probe(matrices("D=[[2.0]]"), 3.0).controller.model_dump()
    assert (law["D"], law["C"]) == ([[6.0]], [[]])
    assert "gain" not in law


def test_the_verb_draws_it(tmp_path: Path):
    changes = [f"--set={change}" for change in (*SLOW, "controller.kind=state-space", "controller.dt=100ms")]
    changes += ["--set=controller.D=[[37.0]]"]
    ranges = ("gain", "delay", "--x", "0.1:4", "--y", "0:100", "--cells", "12")
    done = hydrotwin_here("map", "--rig", "step", *changes, *ranges, "--runs", "0", "-o", "chart", cwd=tmp_path)
    assert done.returncode == 0, done
    rows = (tmp_path / "chart.csv").read_text().splitlines()
    assert any(row.startswith("gain [x],delay [ms]") for row in rows), rows[:6]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (
            ("gain", "period"),
            "axis 'period': a law given as matrices has gain, delay, damping",
        ),
        (("gain", "delay", "--at", "derivative=1"), "axis 'derivative': a law given as matrices"),
        (
            ("gain", "delay", "--set=controller.inputs=['p2']"),
            "controller.inputs p2: a chart is of a law that reads error and velocity",
        ),
    ],
)
def test_what_it_does_not_have_is_refused_in_one_line(tmp_path: Path, more: tuple[str, ...], said: str):
    changes = [f"--set={change}" for change in (*SLOW, "controller.kind=state-space", "controller.dt=100ms")]
    done = hydrotwin_here("map", "--rig", "step", *changes, "--set=controller.D=[[37.0]]", *more, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == 1
