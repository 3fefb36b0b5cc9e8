"""The linear model: sampled with hold and delay as the exact solution has it; its page's controllers do their work."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from bridge.errors import ScenarioError
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.studies.linear_model import UNITS, linear_model, sampled_model
from tests.support.command import hydrotwin_here
from tests.support.processes import ROOT
from twin.circuit.linear import INPUTS
from twin.circuit.rates import STATES

PAGE = (ROOT / "docs/linear-model.md").read_text(encoding="utf-8")
LQR, LEAD = 1, 2  # blocks of code of the page
T, FINE = 0.01, 100  # sampling period [s], and parts of it


def block(number: int) -> str:
    return re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)[number]


@pytest.mark.parametrize("parts", [0, 30, 100, 240])
def test_the_sampled_model_is_the_exact_solution_of_the_held_and_delayed_one(parts: int):
    """Random commands, each acting so many hundredths of a period after its sample; a force that is held, not delayed.

    The witness is the continuous model, stepped a hundredth of a period at a time.
    """
    model = linear_model(load("step"), "up", friction=2e3)
    system = model.continuous
    sampled = sampled_model(system, T, parts * T / FINE)
    held = np.zeros((len(INPUTS), len(STATES) + len(INPUTS)))
    whole = np.vstack([np.hstack([system.A, system.B]), held])
    fine = expm(whole * T / FINE)[: len(STATES)]
    rng = np.random.default_rng(1)
    commands, forces = 0.01 * rng.standard_normal(30), 100.0 * rng.standard_normal(30)
    x, z = np.zeros(len(STATES)), np.zeros(sampled.nstates)
    for k in range(30):
        assert sampled.C @ z == pytest.approx(system.C @ x, rel=1e-7, abs=1e-9 * float(np.abs(system.C @ x).max()))
        for part in range(FINE):
            sent = (k * FINE + part - parts) // FINE
            x = fine @ np.concatenate([x, [commands[sent] if sent >= 0 else 0.0, forces[k]]])
        z = sampled.A @ z + sampled.B @ np.array([commands[k], forces[k]])


def test_each_whole_interval_of_delay_is_a_state_and_a_rest_another():
    counts = [linear_model(load("step", [f"loop.delay={ms} ms"])).sampled.nstates for ms in (0, 5, 10, 25)]
    assert counts == [len(STATES) + more for more in (0, 1, 1, 3)]


def test_the_model_moves_as_the_point_says():
    """About a steady motion upwards: the velocity follows the spool by the slope of the points themselves."""
    at = {spool: linear_model(load("step"), str(spool)) for spool in (0.299, 0.3, 0.301)}
    slope = (at[0.301].at["velocity"] - at[0.299].at["velocity"]) / 0.002
    channel: Any = at[0.3].continuous
    gain = channel["velocity", "spool_reference"](1e-4j)
    assert abs(gain) == pytest.approx(slope, rel=2e-3)


@pytest.mark.parametrize(
    ("point", "changes", "complaint"),
    [
        ("sideways", [], "neither 'rest', 'up', 'down' nor a spool position"),
        ("0.05", [], "inside the overlap"),
        ("2", [], "from -1 to 1"),
        ("rest", ["rig.cylinder.leakage_resistance=inf"], "take 'up' or 'down'"),
        ("up", ["rig.valve.kind=switching"], "a switching valve"),
    ],
)
def test_a_point_that_is_not_there_is_refused(point: str, changes: list[str], complaint: str):
    scenario = load("step", changes)
    with pytest.raises(ScenarioError, match=complaint):
        linear_model(scenario, point)


def test_the_verb_writes_names_units_and_matrices(tmp_path: Path):
    done = hydrotwin_here("linearise", "step", "-o", "model.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "sampled every 10 ms with 5 ms of delay: 20 states" in done.stdout
    found = json.loads((tmp_path / "model.json").read_text())
    assert found["inputs"] == {"spool_reference": "of travel", "force": "N"}
    assert list(found["continuous"]["states"]) == list(STATES)
    assert found["continuous"]["states"] == {name: UNITS[name] for name in STATES}
    assert found["sampled"]["dt"] == 0.01
    assert np.array(found["sampled"]["A"]) == pytest.approx(linear_model(load("step")).sampled.A)


@pytest.mark.parametrize(
    ("name", "file", "number", "law", "more"),
    [
        ("step", "lqr.py", LQR, "law", []),
        ("delay", "lead.py", LEAD, "system", ["controller.gain=1 1/m", "controller.compensate_overlap=true"]),
    ],
)
def test_the_page_s_controllers_settle_without_overshoot(
    name: str, file: str, number: int, law: str, more: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    Path(file).write_text(block(number))
    scenario = load(name, ["controller.kind=python", f"controller.law={file}:{law}", "duration=5", *more])
    metrics = record_in_process(scenario, tmp_path / "a.mcap").metadata["summary"]["metrics"]
    assert metrics["overshoot"] * 60.0 < 1.0  # mm
    assert metrics["settling_time"] < (0.5 if name == "step" else 1.0)
    assert metrics["limit_cycle_amplitude"] < 0.3e-3
    assert math.isfinite(metrics["rise_time"])


def test_the_page_s_matrices_are_a_law(tmp_path: Path):
    text = PAGE.partition("```toml\n")[2].partition("```")[0]
    (tmp_path / "own.toml").write_text(text)
    scenario = load(str(tmp_path / "own.toml"))
    metrics = record_in_process(scenario, tmp_path / "a.mcap").metadata["summary"]["metrics"]
    assert metrics["settling_time"] < 0.5
    assert metrics["overshoot"] < 0.05
