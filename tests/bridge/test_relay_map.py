"""A relay's loop on the rig: the reduced drive beside the twin, over its times; what a map says of itself."""

import csv
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from bridge.cli.verbs import app
from bridge.drawing import canvas
from bridge.scenario import load
from bridge.studies.stability.relay_lead import critical_lead, needed_lead
from bridge.studies.stability.relay_swing import Place, found_on_twin, predicted
from bridge.studies.sweep.engine import HERE

VALVES = {"proportional": ["rig.valve.kind=proportional"], "switching": []}
PLACES = [Place(1e-3, 0.0, 0.0), Place(5e-3, 10e-3, 20e-3), Place(24e-3, 0.0, 20e-3)]


@pytest.mark.parametrize("valve", VALVES)
def test_the_twin_swings_as_the_reduced_drive_does(valve: str):
    """Peak to peak within 30 %, and of the proportional valve the frequency within 20 %."""
    scenario = load("relay", VALVES[valve])
    for one, other in zip(predicted(scenario, PLACES), found_on_twin(scenario, PLACES, None, HERE), strict=True):
        assert one.peak_to_peak == pytest.approx(other.peak_to_peak, rel=0.3)
        if valve == "proportional":
            assert one.frequency == pytest.approx(other.frequency, rel=0.2)


@pytest.mark.parametrize("valve", VALVES)
@pytest.mark.parametrize(("period", "delay"), [(1e-3, 0.0), (5e-3, 0.0), (5e-3, 5e-3), (10e-3, 0.0)])
def test_the_swing_grows_where_5_22_asks_for_more_lead(valve: str, period: float, delay: float):
    """On one side of the edge and on the other, in theory; the edge grows by the dead time."""
    scenario = load("relay", VALVES[valve])
    edge = needed_lead(scenario, period, delay)
    assert edge - critical_lead(scenario) == pytest.approx(delay + 0.5 * period)
    without, least, more = predicted(scenario, [Place(period, delay, f * edge) for f in (0.0, 2.0, 3.0)])
    assert without.peak_to_peak > 1.4 * least.peak_to_peak
    assert more.peak_to_peak > 0.5 * least.peak_to_peak  # beyond, further lead changes little


def invoke(*words: str):
    return CliRunner().invoke(app, ["map", *words])


def rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def test_a_map_of_a_relay_has_the_twin_beside_it(tmp_path: Path):
    words = ["--x", "1:20", "--y", "0:30", "--cells", "4", "--runs", "1", "--workers", "1", "-o", str(tmp_path / "m")]
    done = invoke("period", "derivative", "--rig", "relay", "--at", "delay=2", *words)
    assert done.exit_code == 0, done.output
    table, (run,) = rows(tmp_path / "m.csv"), rows(tmp_path / "m-runs.csv")
    assert len(table) == 16
    assert {row["delay [ms]"] for row in table} == {"2"}
    near = [float(row["peak to peak [mm]"]) for row in table]
    assert min(near) < 2e3 * float(run["amplitude"]) < max(near)
    page = (tmp_path / "m.html").read_text()
    assert "Fixed: delay [ms] = 2, mass [kg] = 120, position [mm] = 130." in page
    assert "http" not in page


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        (("gain", "period"), "a relay has no 'gain' to vary; take two of period, delay, derivative"),
        (("period", "period"), "both axes are 'period'"),
        (("period", "delay", "--about", "up"), "has no linear point"),
        (("period", "delay", "--x", "0.2:3"), "start at 1 or more"),
        (("period", "delay", "--at", "gain=3"), "write NAME=NUMBER with one of period, delay, derivative"),
    ],
)
def test_what_a_relay_does_not_have_is_refused(words: tuple[str, ...], answer: str, tmp_path: Path):
    done = invoke(*words, "--rig", "relay", "--runs", "0", "-o", str(tmp_path / "m"))
    assert done.exit_code != 0
    assert answer in (done.output + str(done.exception))


@pytest.mark.parametrize(
    ("words", "fixed"),
    [
        ((), {"derivative d": 0.0, "delay delay/tau": 0.0, "damping k": 0.1, "gamma": 0.23}),
        (("--at", "gamma=0.1", "--derivative", "filtered", "--filter-time", "2"), {"gamma": 0.1, "filter time/tau": 2}),
        (
            ("--rig", "slow-sampling", "--at", "delay=7"),
            {"delay [ms]": 7.0, "mass [kg]": 120.0, "position [mm]": 160.0},
        ),
    ],
)
def test_a_map_names_its_fixed_numbers(
    words: tuple[str, ...], fixed: dict[str, float], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """In the table, on the page and in the picture."""
    drawn: list[str] = []
    monkeypatch.setattr(canvas, "remark", lambda page, text: drawn.append(text))
    done = invoke("period", "gain", *words, "--cells", "3", "--runs", "0", "-o", str(tmp_path / "m"))
    assert done.exit_code == 0, done.output
    table, page = rows(tmp_path / "m.csv"), (tmp_path / "m.html").read_text()
    for name, value in fixed.items():
        assert np.array([float(row[name]) for row in table]) == pytest.approx(value)
        assert f"{name} = {value:.4g}" in page
        assert f"{name} = {value:.4g}" in drawn[0].replace("\n", " ")
