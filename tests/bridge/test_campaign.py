"""What campaigns are made of: pieces laid over scenarios, draws, intervals, the halving for the smallest fault."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import binom, binomtest, kstest, loguniform, norm, uniform

from bridge.runs.campaign.campaign import Judged, failures_of
from bridge.runs.campaign.draws import Distribution, draw_of, drawn, value_at
from bridge.runs.campaign.file import KEYS, Fault, read_campaign
from bridge.runs.campaign.margins import MARGINS, Margin, MarginRun, margin_axes
from bridge.runs.campaign.matrix import Run, matrix_of, refuse, runs_of
from bridge.runs.campaign.places import numbers_in, on_grid, replaced
from bridge.runs.campaign.shrink import HALVINGS, Wish, shrunk, wishes_of
from bridge.runs.campaign.statistics import quantile, ranks, wilson
from bridge.scenario import changed, load
from bridge.scenario.faults import planned
from bridge.scenario.files import with_piece
from tests.support.processes import ROOT

TAKEN = {"delay": "8 ms", "jitter": "8 ms", "loss": "8 %"}
DRAWN = {
    Distribution.UNIFORM: (["2 kg", "8 kg"], uniform(2, 6)),
    Distribution.LOG_UNIFORM: (["2", "800"], loguniform(2, 800)),
    Distribution.NORMAL: (["5 mm", "2 mm"], norm(5, 2)),
}


def campaign(folder: Path, text: str) -> Any:
    (folder / "c.toml").write_text(text)
    return matrix_of(read_campaign(folder / "c.toml"))


@pytest.mark.parametrize("passed", [0, 1, 7, 19, 20])
def test_the_share_is_wilsons(passed: int):
    found, known = wilson(passed, 20), binomtest(passed, 20).proportion_ci(method="wilson")
    assert (found.low, found.high) == pytest.approx((known.low, known.high), abs=1e-12)


@pytest.mark.parametrize(("count", "share"), [(10, 0.5), (59, 0.95), (200, 0.05), (1000, 0.5)])
def test_the_ranks_of_a_quantile_are_the_tightest_that_keep_each_tail(count: int, share: float):
    low, high = ranks(count, share)
    number = binom(count, share)
    if low is not None:
        assert number.cdf(low - 1) <= 0.025 < number.cdf(low)
    if high is not None:
        assert number.sf(high - 1) <= 0.025 < number.sf(high - 2)


def test_few_runs_have_no_interval_of_a_far_quantile():
    """0.95^n is the chance that none of n lies above: below 2.5 % from n = 72 on."""
    assert quantile(range(71), 0.95).high is None
    assert quantile(range(72), 0.95).high == 71


def test_a_quantile_is_that_of_numpy():
    values = np.random.default_rng(1).normal(size=37).tolist()
    for share in (0.05, 0.5, 0.95):
        assert quantile(values, share).value == pytest.approx(np.quantile(values, share), rel=1e-12)


@pytest.mark.parametrize("kind", Distribution)
def test_draws_have_their_distribution(kind: Distribution):
    texts, known = DRAWN[kind]
    found = [float(text.split()[0]) for text in drawn(draw_of("x", kind, texts), 1, 2000, 1e-6)]
    assert kstest(found, known.cdf).pvalue > 0.01


def test_a_normal_number_cut_off_stays_between_its_ends():
    cut = draw_of("x", Distribution.NORMAL, ["5 V", "2 V", "4 V", "9 V"])
    assert value_at(cut, 0.0) == pytest.approx(4.0)
    assert value_at(cut, 1.0) == pytest.approx(9.0)
    share = (norm.cdf(6, 5, 2) - norm.cdf(4, 5, 2)) / (norm.cdf(9, 5, 2) - norm.cdf(4, 5, 2))
    assert value_at(cut, float(share)) == pytest.approx(6.0)


def test_a_number_is_drawn_alike_whatever_else_is_and_however_many_follow():
    one, other = (draw_of(name, Distribution.UNIFORM, ["0 ms", "9 ms"]) for name in ("a", "b"))
    assert drawn(one, 3, 5, 1e-9) == drawn(one, 3, 50, 1e-9)[:5]
    assert len({*drawn(one, 3, 5, 1e-9), *drawn(other, 3, 5, 1e-9), *drawn(one, 4, 5, 1e-9)}) == 15
    steps = [float(text.split()[0]) / 0.05 for text in drawn(one, 3, 50, 50e-6)]
    assert steps == pytest.approx([round(step) for step in steps])


def test_a_piece_adds_what_happens_and_replaces_numbers():
    base = load("step", ['timeline=[{set = "controller.gain", at = "1 s", to = "2 V/%"}]']).model_dump(mode="json")
    push = {"set": "rig.load.force", "at": "2 s", "to": "1 kN"}
    data = with_piece(base, {"timeline": [push], "rig": {"load": {"mass": "3 t"}}, "controller": {"kind": "pid"}})
    found = changed(data, [], "step")
    assert [entry.set for entry in found.timeline] == ["controller.gain", "rig.load.force"]
    assert (found.rig.load.mass, found.controller.kind) == (3000.0, "pid")
    assert found.rig.load.model_copy(update={"mass": base["rig"]["load"]["mass"]}) == load("step").rig.load


def test_the_numbers_of_a_fault_are_found_and_replaced():
    piece = {"timeline": [{"set": "reference", "at": "1 s", "to": 3}], "daq": {"clip": False, "bits": 8}}
    assert dict(numbers_in(piece)) == {"timeline.1.at": "1 s", "timeline.1.to": "3", "daq.bits": "8"}
    assert replaced(piece, {"timeline.1.to": "4"})["timeline"] == [{"set": "reference", "at": "1 s", "to": "4"}]
    assert piece["timeline"][0]["to"] == 3


def test_only_times_lie_on_the_grid():
    assert on_grid(0.13, "ms", 50e-6) == pytest.approx(0.15)
    assert on_grid(0.13, "bar", 50e-6) == 0.13


def test_a_number_of_a_fault_multiplies_only_its_own_runs(tmp_path: Path):
    text = (
        "scenarios = ['step']\nseeds = 2\nfaults.a.rig.load.mass = '9 kg'\nparameters.a.rig.load.mass = '1 kg:4 kg:4'"
    )
    found = runs_of(campaign(tmp_path, text))
    assert [(run.fault, *run.parameters, run.seed) for run in found[:4]] == [
        *(("none", "", 1), ("none", "", 2)),
        *(("a", "1 kg", 1), ("a", "1 kg", 2)),
    ]
    assert len(found) == 2 + 2 * 4
    assert found[3].point["placed"] == {"rig.load.mass": "1 kg"}


def edge(at: float) -> Any:
    """Whoever runs: a band breaks beyond a number."""

    def ask(points: list[Any]) -> list[Any]:
        values = [float(point["placed"]["x"].split()[0]) for point in points]
        return [{"reason": "", "bands": [{"band": "b", "passed": value <= at}]} for value in values]

    return ask


@pytest.mark.parametrize("at", [13.0, 99.9])
def test_halving_encloses_the_edge(at: float):
    wish = Wish(Fault("f", "", {"x": 1}, ()), "x", 0.0, 100.0, "N", 50e-6)
    run: Any = SimpleNamespace(fault="f", cell=("s", "f", ()), point={})
    (found,) = shrunk([wish], SimpleNamespace(), [run], edge(at))  # pyright: ignore[reportArgumentType]
    assert found.keeps is not None and found.breaks is not None  # noqa: PT018
    assert found.keeps <= at < found.breaks
    assert found.breaks - found.keeps == pytest.approx(100.0 / 2**HALVINGS)
    (never,) = shrunk([wish], SimpleNamespace(), [run], edge(200.0))  # pyright: ignore[reportArgumentType]
    (always,) = shrunk([wish], SimpleNamespace(), [run], edge(-1.0))  # pyright: ignore[reportArgumentType]
    assert never.words == "keeps all bands up to 100 N"
    assert always.words == "breaks 'b' even at 0 N"


def test_what_is_harmless_is_what_the_scenario_has(tmp_path: Path):
    text = (
        "scenarios = ['step']\n[faults]\na.rig.load.mass = '9000 kg'\n"
        "b.timeline = [{set = 'rig.load.force', at = '1 s', to = '-3 kN'}]"
    )
    found = campaign(tmp_path, text)
    mass, force = wishes_of(["a", "b.timeline.1.to"], found)
    assert mass[2:5] == (load("step").rig.load.mass, 9000.0, "kg")
    assert force[2:5] == (0.0, -3.0, "kN")


def test_a_margin_ends_at_the_first_value_that_any_seed_breaks():
    axis: Any = SimpleNamespace(texts=("0 ms", "1 ms", "2 ms", "3 ms"))
    kept = {(0, 1): True, (0, 2): True, (1, 1): True, (1, 2): False, (2, 1): True, (2, 2): True}
    runs = [
        MarginRun(place, seed, {"reason": "", "bands": [{"band": "b", "passed": passed}]})
        for (place, seed), passed in kept.items()
    ]
    found = Margin("s", "delay", axis, runs, {})
    assert (found.kept, found.broken) == (1, "b")


def test_what_failed_is_grouped_by_what_broke_most_and_ordered_by_how_much():
    def one(number: int, fault: str, reason: str = "", **excess: float) -> Judged:
        bands = [{"band": name, "id": "", "passed": by == 0.0, "excess": by} for name, by in excess.items()]
        return Judged(Run(number, "s", fault, (), (), 1, {}), {"reason": reason, "bands": bands})

    runs = [one(1, "a", x=0.1, y=0.2), one(2, "a", x=0.0, y=0.5), one(3, "b", x=0.3, y=0.0), one(4, "b", "crashed")]
    found = failures_of([*runs, one(5, "a", x=0.0, y=0.0)])
    assert [[judged.run.number for judged in failure.runs] for failure in found] == [[4], [2, 1], [3]]
    assert [failure.of for failure in found] == [2, 3, 2]


PAGE = (ROOT / "docs/campaigns.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("text", re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL))
def test_the_campaigns_of_the_page_can_be_run(tmp_path: Path, text: str):
    """Every file of it is read, and each of its columns is one of its scenarios."""
    found = campaign(tmp_path, text)
    margin_axes(found)
    refuse(found, runs_of(found))


def test_the_campaign_of_our_own_weaknesses_can_be_run():
    found = matrix_of(read_campaign(ROOT / "examples/campaigns/weaknesses.toml"))
    assert len(runs_of(found)) == 2 * 10 * 2 * 5
    assert [wish.words for wish in wishes_of(found.file.shrink, found)] == [
        "pump-stops.timeline.1.lasts",
        "glitch.timeline.1.to",
    ]
    refuse(found, runs_of(found))


def test_the_page_names_every_key():
    assert [key for key in KEYS if f"`{key}" not in PAGE and f", `{key}`" not in PAGE] == []


def test_each_disturbance_becomes_a_piece_that_scenarios_take():
    """Jitter from 0 to 8 ms is 4 +- 4 ms; nothing of a disturbance is no fault at all."""
    base = load("step").model_dump(mode="json")
    made = {kind: changed(with_piece(base, row.piece(TAKEN[kind])), [], "step") for kind, row in MARGINS.items()}
    assert made["delay"].loop.delay == 8e-3
    (jitter,), (loss,) = planned(made["jitter"]), planned(made["loss"])
    assert (jitter.target, jitter.word, jitter.sizes["time"], jitter.sizes["spread"]) == (
        *("link.command", "uniform"),
        *(4e-3, 4e-3),
    )
    assert (loss.kind, loss.sizes["share"], loss.begins) == ("loss", 0.08, (0,))
    assert MARGINS["jitter"].piece("0 ms") == MARGINS["loss"].piece("0 %") == {}
