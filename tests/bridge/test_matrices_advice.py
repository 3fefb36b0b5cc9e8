"""Advice on a law given as matrices, and on one in C: as on the same law in another form."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge.errors import ScenarioError
from bridge.scenario import Scenario, load
from bridge.studies.stability import amplitude
from bridge.studies.stability.advice import advise
from bridge.studies.stability.advised import Advice
from bridge.studies.stability.amplitude import loop_of
from bridge.studies.stability.probe import stand_of
from bridge.studies.stability.sampled_law import at_free, at_gain, free_gain, is_asked
from bridge.studies.stability.trial import trial
from controller.stability.amplitude.edges import SEEDS, swing

SLOW = ["loop.sample_period=100ms", "loop.command_timeout=1"]
EXACT = ["daq.noise=0", "daq.quantise=false"]
PD = load("step", SLOW)
OWN = free_gain(PD).own
STEP = 0.02


def matrices(*changes: str, more: Sequence[str] = ()) -> Scenario:
    return load("step", [*SLOW, *more, "controller.kind=state-space", "controller.dt=100ms", *changes])


@pytest.mark.parametrize(
    ("D", "inputs"),
    [
        ("[[1.0]]", "['error']"),
        ("[[1.0, -1.0]]", "['reference', 'position']"),
        ("[[0.5, 0.5, -0.5, 0.0]]", "['error', 'reference', 'position', 'velocity']"),
    ],
)
def test_a_gain_on_the_error_is_the_proportional_controller(D: str, inputs: str):
    asked = matrices(f"controller.D={D}", f"controller.inputs={inputs}")
    assert free_gain(asked) == (1.0, "x", 1.0)
    assert not is_asked(asked)
    assert swing(loop_of(asked), 8.0 * OWN, STEP) == swing(loop_of(PD), 8.0 * OWN, STEP)


def test_velocity_is_that_of_the_tachometer():
    changes = ["controller.gain=300 1/m", "controller.derivative=5 s/m"]
    asked = matrices("controller.D=[[300.0, -5.0]]", "controller.inputs=['error', 'velocity']")
    assert swing(loop_of(asked), 1.0, STEP) == swing(loop_of(load("step", [*SLOW, *changes])), 300.0, STEP)


def test_a_lag_swings_as_the_same_lag_of_the_package_control(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Whose swing is compared with the twin's in test_advice.py."""
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text("import control\nlag = control.tf([0.3], [1.0, -0.7], 0.1)\n")
    theirs = load("step", [*SLOW, "controller.kind=python", "controller.law=mine.py:lag"])
    rows = [f"controller.{name}" for name in ("A=[[0.7]]", "B=[[1.0]]", "C=[[0.3]]", "D=[[0.0]]")]
    found = swing(loop_of(matrices(*rows)), 5.0 * OWN, STEP)
    assert found.counts
    assert found == swing(loop_of(theirs), 5.0 * OWN, STEP)


def test_the_twin_runs_at_the_same_factor():
    """A factor on C and D is the gain itself: the same true positions as at that gain."""
    short = "duration=1.5"
    asked = load("step", [*SLOW, short, "controller.kind=state-space", "controller.dt=100ms", "controller.D=[[10.0]]"])
    changed, factor = at_free(asked, 3.0, free_gain(asked))
    pd = at_gain(load("step", [*SLOW, short]), 30.0)
    assert factor == 1.0
    positions = trial(changed, stand_of(pd)).position
    assert np.ptp(positions) > 0.01
    assert positions == pytest.approx(trial(pd, stand_of(pd)).position, abs=1e-12)


def test_advice_has_factors_and_no_derivative(monkeypatch: pytest.MonkeyPatch):
    """With fewer motions than usual; the own gain is in the middle of the rows of a loop that swings at times."""
    monkeypatch.setattr(amplitude, "FURTHER", ())
    monkeypatch.setattr(amplitude, "ASKED", (STEP,))
    monkeypatch.setattr(amplitude, "SEEDS", SEEDS[:1])
    found = advise(matrices(f"controller.D=[[{2.0 * OWN!r}]]"), (STEP,))
    assert isinstance(found, Advice)
    assert (found.unit, found.timing.derivative) == ("x", "none")
    assert found.gain == (None, 1.0)
    low, high = found.settles_below.volts, found.swings_above.volts
    assert low is not None
    assert high is not None
    assert 0.0 < low < high
    assert any("a factor on C and D" in note for note in found.notes)


@pytest.mark.parametrize("inputs", ["['error', 'p2']", "['error', 'reference velocity']"])
def test_what_reads_more_than_the_linear_loop_has_runs_itself(inputs: str):
    """Here with a weight of 0 beside the error: the same swing."""
    asked = matrices("controller.D=[[1.0, 0.0]]", f"controller.inputs={inputs}", more=EXACT)
    assert is_asked(asked)
    exact = load("step", [*SLOW, *EXACT])
    found, linear = swing(loop_of(asked), 8.0 * OWN, STEP), swing(loop_of(exact), 8.0 * OWN, STEP)
    assert found.frequency == pytest.approx(linear.frequency, rel=1e-3)
    assert found.peak_to_peak == pytest.approx(linear.peak_to_peak, rel=1e-3)


def test_a_law_that_knows_where_it_stands_runs_itself():
    """The linear loop counts positions from where the run starts."""
    assert is_asked(matrices("controller.D=[[1.0, -0.9]]", "controller.inputs=['reference', 'position']"))
    leak = ["controller.A=[[1.0]]", "controller.B=[[1.0, 0.0]]", "controller.C=[[0.1]]", "controller.D=[[5.0, 1.0]]"]
    assert is_asked(matrices(*leak, "controller.inputs=['position', 'error']"))


C_LAW = """\
#include "hydrotwin_law.h"
const int32_t hydrotwin_law_version = HYDROTWIN_LAW_VERSION;
int hydrotwin_law(const hydrotwin_sample *s, const hydrotwin_target *t, const hydrotwin_facts *f, const double *p,
                  double *memory, double *spool, double *signals) {
  static double last;
  *spool = 20.0 * (t->position - s->position) + 0.1 * last;
  last = *spool;
  return 0;
}
"""
PYTHON_LAW = """\
def law(sample, target, memory, gains):
    spool = 20.0 * (target.position - sample.position) + 0.1 * (memory or 0.0)
    return spool, spool
"""


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler `cc` on this machine")
def test_a_law_in_c_runs_itself_as_one_in_python_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """To the last bit, with a static variable that each run has for itself."""
    monkeypatch.chdir(tmp_path)
    Path("law.c").write_text(C_LAW)
    Path("mine.py").write_text(PYTHON_LAW)
    ours = load("step", [*SLOW, "controller.kind=c", "controller.source=law.c"])
    theirs = load("step", [*SLOW, "controller.kind=python", "controller.law=mine.py:law"])
    assert free_gain(ours) == free_gain(theirs) == (1.0, "x", 1.0)
    found: list[Any] = [swing(loop_of(asked), 8.0 * OWN / 20.0, STEP) for asked in (ours, theirs)]
    assert found[0].counts
    assert found[0] == found[1]
    assert swing(loop_of(ours), 8.0 * OWN / 20.0, STEP) == found[0]


def test_an_open_loop_has_still_no_gain():
    with pytest.raises(ScenarioError, match="kind 'open-loop' has no gain to advise on"):
        free_gain(load("hold-load"))
