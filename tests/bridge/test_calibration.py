"""The calibrated rig against the facts of the thesis, the numbers before it, and the fit on a known problem."""

from functools import cache

import numpy as np
import pytest

from bridge.scenario import load
from bridge.studies.calibration import fit
from bridge.studies.calibration.__main__ import BEFORE, rig_of, weight
from bridge.studies.calibration.choices import CHOICES, chosen, of_the_rig, overrides, priors, scaled
from bridge.studies.calibration.facts import FACTS, evaluate, misses
from twin.rig import RIG

MISSED = {  # nothing tried meets them together with 0.38 m/s: docs/calibration.md
    "restart: peak of p2": 82.0,
    "impingement: greatest p3": 33.0,
    "impingement: greatest p2": 92.0,
}


@cache
def found() -> dict[str, float]:
    return evaluate(overrides(of_the_rig()))


@pytest.mark.parametrize("fact", [fact for fact in FACTS if fact.name not in MISSED], ids=lambda fact: fact.name)
def test_the_calibrated_rig_meets_the_facts(fact):
    """Each within its range, or half a scale beside it."""
    assert fact.low - 0.5 * fact.scale <= found()[fact.name] <= fact.high + 0.5 * fact.scale


@pytest.mark.parametrize("name", MISSED)
def test_what_it_misses_it_misses_by_little(name: str):
    fact = next(fact for fact in FACTS if fact.name == name)
    assert fact.low <= found()[name] <= MISSED[name]


def test_the_rig_before_missed_most():
    before = dict(zip([fact.name for fact in FACTS], misses(evaluate(rig_of(BEFORE))), strict=True))
    assert before["friction, five loads"] > 50.0
    assert min(abs(before[f"held, {n} rpm"]) for n in (502, 1230)) > 2.0
    assert (np.abs(list(before.values())) > 0.5).sum() >= 12


def test_every_number_stands_in_its_range_and_says_where_it_comes_from():
    rig = of_the_rig()
    for choice in CHOICES:
        assert choice.low <= rig[choice.name] <= choice.high
        part, _, name = choice.name.partition(".")
        if part != "start" and rig[choice.name] != choice.prior:
            assert "docs/calibration.md" in RIG[part][name].source
    assert load("load-change").start.position == rig["start.position"]


def test_places_in_the_ranges_and_values_are_the_same_thing():
    values = chosen(np.linspace(0.0, 1.0, len(CHOICES)))
    for choice, share in zip(CHOICES, np.linspace(0.0, 1.0, len(CHOICES)), strict=True):
        assert scaled(choice, values[choice.name]) == pytest.approx(share)
    assert chosen(priors())["seal.diameter"] == pytest.approx(82e-3)
    assert overrides({"pipe_3.wall": 4e-3})["pipe_6"] == {"wall": 4e-3}


BOTTOM = np.linspace(0.2, 1.1, len(CHOICES))


def bowl(shares: np.ndarray, _: object = None) -> float:
    """With a corner at its bottom, which for some numbers lies outside their range."""
    return float(np.abs(shares - BOTTOM).sum() + (shares - BOTTOM) @ (shares - BOTTOM))


def test_the_fit_finds_the_bottom_of_a_bowl(monkeypatch: pytest.MonkeyPatch):
    """Within the last width of the pattern, or at the end of the range; the evolution before it gets nearer."""
    monkeypatch.setattr(fit, "cost", bowl)
    evolved = fit.evolve(priors(), 1.0, {})
    assert evolved.cost < bowl(priors())
    found = fit.refine(evolved.shares, 60.0, {})
    assert found.shares == pytest.approx(np.minimum(BOTTOM, 1.0), abs=2 * fit.LAST)


def test_a_weight_names_a_fact():
    assert weight("restart: peak of p2=5") == ("restart: peak of p2", 5.0)
    with pytest.raises(ValueError, match="is not a fact"):
        weight("peak=5")
