"""A scenario's rig in the numbers of the thesis's model, and its mark on charts."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from bridge.cli.verbs import app
from bridge.figures.catalogue import draw_figure
from bridge.scenario import load
from bridge.scenario.circuit import circuit_of
from bridge.studies.stability.equivalent import scaled
from bridge.studies.stability.mark import mark_words
from controller.stability.actuator.model import omega
from twin.circuit.kinds import of_kind
from twin.cylinder import Cylinder


def said(*words: str) -> dict:
    done = CliRunner().invoke(app, ["dimensionless", *words, "--json"])
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout)


def test_the_drive_has_the_oil_spring_of_the_rig():
    """2 omega^2 m = B (A_l^2/V_l + A_u^2/V_u), by the circuit's own capacities: p' = -A v/C."""
    scenario = load("step")
    circuit, found = circuit_of(scenario), scaled(scenario)
    c, hoses = of_kind(circuit.parts.cylinder, Cylinder), circuit.lines.capacity[2:4] * circuit.parts.oil.bulk_modulus
    volumes = np.array([c.dead_lower, c.dead_upper]) + hoses
    x = scenario.start.position
    volumes += np.array([c.area_lower * x, c.area_upper * (c.stroke - x)])
    areas = np.array([c.area_lower, c.area_upper])
    spring = c.bulk_modulus * float(np.sum(areas**2 / volumes))
    assert 2.0 * omega(found.drive) ** 2 * found.drive.mass == pytest.approx(spring, rel=1e-12)
    assert 0.006 < found.numbers.gamma < 0.013
    assert found.numbers.tau == pytest.approx(omega(found.drive) * 0.01)


@pytest.mark.parametrize("name", ["step", "slow-sampling", "relay"])
def test_back_in_si_the_numbers_are_a_scenario_again(name: str):
    """What --at gives as changes of a scenario has those numbers."""
    wanted = {"tau": 2.5, "delay": 0.4, "d": 0.3} | ({} if name == "relay" else {"s": 3.0})
    given = said(name, *(word for number, value in wanted.items() for word in ("--at", f"{number}={value}")))
    period, delay, *gains = (entry.partition("=")[2] for entry in given["changes"])
    assert given["loop"]["period"] == float(period.removesuffix(" s"))
    assert given["loop"]["delay"] == float(delay.removesuffix(" s"))
    names = [entry.partition("=")[0] for entry in given["changes"][2:]]
    again = scaled(load(name, [f"{key}={value!r}" for key, value in zip(names, gains, strict=True)])).numbers
    assert again.d == pytest.approx(wanted["d"], rel=1e-12)
    assert again.s == pytest.approx(wanted.get("s", 1.0), rel=1e-12)
    assert given["numbers"]["gamma"] == pytest.approx(again.gamma, rel=1e-12)


def test_another_gamma_is_another_flow():
    own, other = said("step"), said("step", "--at", "gamma=0.23")
    ratio = 0.23 / own["numbers"]["gamma"]
    assert other["drive"]["flow"] == pytest.approx(ratio * own["drive"]["flow"], rel=1e-12)
    assert other["drive"] | {"flow": 0.0} == pytest.approx(own["drive"] | {"flow": 0.0}, rel=1e-12)


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        (("--at", "gama=1"), "did you mean 'gamma'"),
        (("--at", "gamma=wide"), "'wide' is not a number"),
        (("--at", "tau=0"), "tau 0 must be finite and above 0"),
        (("--set", "controller.kind=open-loop"), "has no gain"),
    ],
)
def test_what_has_no_numbers_is_refused(words: tuple[str, ...], answer: str):
    done = CliRunner().invoke(app, ["dimensionless", "step", *words])
    assert done.exit_code != 0
    assert answer in (done.output + str(done.exception))


def test_a_mark_says_what_is_out_of_the_chart():
    found = scaled(load("step"))
    words = mark_words(found, "period", "gain", ((0.0, 20.0), (0.0, 5.0)), {"gamma": 0.23, "damping": 0.0})
    assert f"tau {found.numbers.tau:.3g}; s {found.numbers.s:.3g}, out of this chart (0 to 5)" in words
    assert f"gamma {found.numbers.gamma:.3g} where this chart has 0.23" in words
    assert "k " not in words.partition("gamma")[2]
    inside = mark_words(found, "period", "gain", ((0.0, 20.0), (0.0, 50.0)), {"gamma": found.numbers.gamma})
    assert "out of" not in inside
    assert "where" not in inside


def test_a_map_and_a_figure_take_a_mark(tmp_path: Path):
    words = ["map", "period", "gain", "--mark", "step", "--cells", "4", "-o", str(tmp_path / "m")]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    assert "Mark: the rig of step" in (tmp_path / "m.html").read_text()
    assert draw_figure("5.8", tmp_path, "step")[0].stat().st_size > 10_000
    done = CliRunner().invoke(app, ["figure", "2.4", "--mark", "step", "-o", str(tmp_path)])
    assert "figure 2.4 is not a dimensionless chart" in str(done.exception)
