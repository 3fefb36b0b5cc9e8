"""`hydrotwin map --simulate`: runs of the nonlinear actuator laid over linear theory."""

import csv
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from bridge.cli.verbs import app
from bridge.studies.stability.actuator_runs import actuator_runs, run_of
from bridge.studies.stability.chart import Plainly
from bridge.studies.sweep.engine import HERE
from bridge.studies.sweep.journal import Journal
from controller.stability.actuator.disagreement import CAUSES


def invoke(*words: str):
    return CliRunner().invoke(app, ["map", *words])


def test_runs_lie_on_the_side_that_theory_says_or_say_why_not(tmp_path: Path):
    """Around a hard flip: at tau 10 a swing stands below the edge; elsewhere runs and colours agree."""
    words = ["--x", "9.4:10.6", "--y", "1.2:1.6", "--at", "start=3", "--cells", "60", "--runs", "5", "--workers", "1"]
    done = invoke("period", "gain", "--simulate", *words, "-o", str(tmp_path / "m"))
    assert done.exit_code == 0, done.output
    with (tmp_path / "m-runs.csv").open() as file:
        runs = list(csv.DictReader(file))
    with (tmp_path / "m.csv").open() as file:
        cells = [[float(value) for value in row.values()] for row in csv.DictReader(file)]
    theory, parted = np.array(cells), 0
    for run in runs:
        x, y = float(run["period tau"]), float(run["gain s"])
        cell = theory[np.argmin(np.hypot((theory[:, 0] - x) / 1.2, (theory[:, 1] - y) / 0.4))]
        if abs(y - 1.4) > 0.02:
            assert (run["oscillates"] == "1") == ((cell[4] > 0) != (run["cause"] != "")), run
        parted += run["cause"] == "hard"
    assert len(runs) == 25
    assert parted >= 1
    assert {run["cause"] for run in runs} <= set(CAUSES) - {"unexplained"}
    page = (tmp_path / "m.html").read_text()
    assert CAUSES["hard"] in page
    assert "runs of the nonlinear actuator, let go 3 alpha from its target" in page
    assert "http" not in page


def test_an_interrupted_map_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    family, places = Plainly({}), [(3.0, 1.0), (3.0, 3.0), (10.0, 1.0)]
    whole = actuator_runs(family, "period", "gain", places, tmp_path / "whole", HERE)
    part, add = tmp_path / "part", Journal.add

    def stop(self, point, result):
        add(self, point, result)
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(Journal, "add", stop)
        with pytest.raises(KeyboardInterrupt):
            actuator_runs(family, "period", "gain", places, part, HERE)
    assert len(part.read_text().splitlines()) == 2
    assert actuator_runs(family, "period", "gain", places, part, HERE) == whole
    assert [run.oscillates for run in whole.runs] == [False, True, False]
    assert whole.runs[1].frequency == pytest.approx(np.pi / 3.0, rel=1e-6)


def test_the_derivative_of_a_map_is_that_of_its_runs():
    """At tau 2 and d 0.8 the tachometer loses every loop that the backward difference keeps up to s 1.50."""
    point = {"s": 0.8, "d": 0.8, "k": 0.1, "gamma": 0.23, "tau": 2.0, "delay": 0.0}
    point |= {"alpha": 0.0043, "limit": 1.0, "start": 0.1, "filter_time": None}
    found = [run_of({**point, "derivative": name})["oscillates"] for name in ("measured", "backward")]
    assert found == [True, False]


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        (("--simulate", "--rig", "step"), "with --rig runs are of the twin"),
        (("--at", "start=3"), "write NAME=NUMBER with one of gain"),
        (("--derivative", "filtered"), "go together"),
        (("--simulate", "--runs", "2", "--at", "start=400"), "the cylinder ends at 1"),
        (("--simulate", "--runs", "2", "--derivative", "exact"), "'exact' is none of"),
    ],
)
def test_what_cannot_be_drawn_is_refused(words: tuple[str, ...], answer: str, tmp_path: Path):
    done = invoke("period", "gain", *words, "--cells", "4", "-o", str(tmp_path / "m"))
    assert done.exit_code != 0
    assert answer in (done.output + str(done.exception))
