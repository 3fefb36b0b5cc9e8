"""Figures 5.7 to 5.19: what the thesis reads from its own charts, and the table of their areas."""

import math

import numpy as np
import pytest

from bridge.figures.stability import charts
from bridge.figures.stability import edges as figure_edges
from bridge.figures.stability.charts import (
    CHARTS,
    CURVES,
    Damped,
    counts,
    draw_areas,
    draw_curves,
    middles,
    shares,
)
from bridge.studies.stability import edges
from bridge.studies.stability.probe import TwinEdge
from bridge.studies.sweep.engine import HERE
from controller.stability import Timing, is_stable, linear_actuator, loop_onset, monodromy, multipliers, sampled_loop

TAU, S = middles(20.0), middles(5.0)


def cell(of: Damped, tau: float, s: float) -> int:
    """Stable multipliers of the cell that holds a point."""
    return int(counts(of)[int(s / 5.0 * 200), int(tau / 20.0 * 200)])


def test_areas_are_those_of_eigenvalues():
    """200 x 200 cells of each chart, counted by numpy's eigenvalues: 1e-12 inside the circle is stable."""
    columns, _ = draw_areas()
    table = np.array(list(columns.values())).T
    for row, of in zip(table, CHARTS.values(), strict=True):
        assert tuple(row[:2]) == of
        assert row[2:].sum() == pytest.approx(1.0, abs=1e-12)
    for number in ("5.9", "5.16", "5.19"):
        of = CHARTS[number]
        size = np.abs(multipliers(monodromy(S[:, None], of.d, of.k, 0.23, Timing(TAU))))
        found = np.bincount((size < 1.0 - 1e-12).sum(axis=-1).ravel(), minlength=4) / 40_000
        np.testing.assert_array_equal(found, shares(of))


def test_derivative_gain_of_a_half_destabilises_the_example_of_the_thesis():
    """tau 3, s 0.5: stable in 5.14, not in 5.16. The stable islands move up; they hardly shrink until d = 1."""
    assert cell(CHARTS["5.14"], 3.0, 0.5) == 3
    assert cell(CHARTS["5.16"], 3.0, 0.5) < 3
    stable = [shares(CHARTS[f"5.{n}"])[3] for n in range(14, 20)]
    assert max(stable[:4]) - min(stable[:4]) < 0.01
    assert stable[5] < 0.1 * stable[0]


def test_damping_stabilises():
    """Every step of k to 10 adds area, and at short intervals the edge is the analogue one, 6.149 k."""
    stable = [shares(CHARTS[f"5.{n}"])[3] for n in range(8, 13)]
    assert np.all(np.diff(stable) > 0.05)
    for k in (0.1, 0.5):
        column = counts(Damped(k, 0.0))[:, 0]
        assert S[column == 3].max() == pytest.approx(6.149 * k, rel=0.03)


@pytest.mark.parametrize(
    ("k", "tau", "kind"), [(1.0, 5.0, "flip"), (10.0, 3.0, "Neimark-Sacker"), (1e3, 9.0, "Neimark-Sacker")]
)
def test_moderate_damping_flips_and_heavy_damping_swings_slowly(k: float, tau: float, kind: str):
    """5.11 to 5.13. Heavily damped it swings at the loop's own omega^2 = sqrt2 gamma s/k, slowly."""
    onset = loop_onset(sampled_loop(linear_actuator(k, 0.23), Timing(tau)), 0.0)
    assert onset is not None
    assert onset.kind == kind
    if k == 1e3:
        own = math.sqrt(math.sqrt(2.0) * 0.23 * onset.gain / k)
        assert onset.angle / tau == pytest.approx(own, rel=0.02)
        assert own < 0.02 * math.sqrt(2.0)


def test_closed_curves_bound_the_islands():
    """5.7: between flip above and pair below it is stable, beyond either it is not; all of it is 5.17."""
    columns, _ = draw_curves()
    tau, flip, pair = (columns[name] for name in ("tau [-]", "flip s [-]", "Neimark-Sacker s [-]"))
    both = (columns["flip bounds stability [0 or 1]"] == 1.0) & (
        columns["Neimark-Sacker bounds stability [0 or 1]"] == 1.0
    )
    assert both.sum() > 0.3 * len(tau)
    for share, stable in ((-0.05, False), (0.05, True), (0.5, True), (0.95, True), (1.05, False)):
        s = pair[both] + share * (flip[both] - pair[both])
        s, at = s[s > 0.0], tau[both][s > 0.0]
        assert np.mean(is_stable(monodromy(s, CURVES.d, CURVES.k, 0.23, Timing(at))) == stable) > 0.99
    assert CHARTS["5.17"] == CURVES


def test_both_branches_of_a_pair_meet_where_their_curve_turns():
    """Between them the curve of 5.9 is drawn without a gap that is seen: a hundredth of the axis."""
    _, _, (low, high) = charts.damped_curves(charts.CHARTS["5.9"])
    both = np.isfinite(low) & np.isfinite(high)
    turns = np.flatnonzero(np.diff(both.astype(int)) == 1) + 1
    gaps = (high - low)[turns[high[turns] < charts.HIGHEST]]
    assert gaps.size
    assert gaps.max() < 0.01 * charts.HIGHEST


@pytest.mark.endurance
@pytest.mark.timeout(900)
@pytest.mark.parametrize("name", [name for name, of in charts.CHARTS.items() if of.k > 0.0])
def test_a_chart_with_damping_lacks_no_edge(name: str):
    """Wherever a cell is stable and its neighbour is not, a curve that is drawn strongly passes within 1.5 cells."""
    of, scale = charts.CHARTS[name], charts.CELLS * np.array([1.0 / charts.LONGEST, 1.0 / charts.HIGHEST])
    tau, flip, pairs = charts.damped_curves(of)
    curves = [np.where((s > 0.0) & (s < 1.02 * charts.HIGHEST), s, np.nan) for s in (flip, *pairs)]
    drawn = np.concatenate([np.stack([tau, s], 1)[charts.edges(tau, s, of)] for s in curves]) * scale
    stable = charts.counts(of) == 3
    across, up = (np.argwhere(np.diff(stable, axis=axis))[:, ::-1] for axis in (1, 0))
    borders = np.concatenate([across + np.array([1.0, 0.5]), up + np.array([0.5, 1.0])])
    assert max(np.abs(drawn - border).max(axis=1).min() for border in borders) < 1.5


def test_an_interrupted_figure_of_measured_edges_continues(tmp_path, monkeypatch):
    """Of six edges that cost nothing the fourth is interrupted: the second call asks for three and sorts all."""
    asked = []

    def found(point, base):
        asked.append(point)
        if len(asked) == 4:
            raise KeyboardInterrupt
        gain = 1.0 + point["sample_period"] + 10.0 * point["delay"] + 100.0 * point["size"]
        return {"stable": gain, "unstable": gain, "frequency": 1.0}

    monkeypatch.setattr(edges, "edge_of", found)
    scenario, part = figure_edges.rig(), tmp_path / "5.21.part"
    cases = ((0.0, (2e-3, 20e-3)), (1.0, (2e-3,)))
    with pytest.raises(KeyboardInterrupt):
        figure_edges.measured((0.1, 0.2), scenario, cases, part, HERE)
    assert part.is_file()
    now, late = figure_edges.measured((0.1, 0.2), scenario, cases, part, HERE)
    assert len(asked) == 7
    assert not part.exists()
    unit = figure_edges.volts(1.0, scenario)
    assert now["step of +20 mm: critical gain [V/%]"] == pytest.approx([3.1 * unit, 3.2 * unit])
    assert now["never oscillates below [V/%]"] == pytest.approx([1.3 * unit, 1.4 * unit])
    assert late["always oscillates above [V/%]"] == pytest.approx([2.3 * unit, 3.4 * unit])


def test_steps_at_one_interval_share_their_theory(monkeypatch):
    """It is computed for two intervals, not for four edges."""
    counted = []
    monkeypatch.setattr(edges, "at_rest", lambda scenario: scenario)
    monkeypatch.setattr(edges, "plants", lambda scenario: counted.append(scenario.loop.sample_period) or {})
    monkeypatch.setattr(edges, "theory_edges", lambda *_: {"rest": [1.0, "flip", 5.0]})
    monkeypatch.setattr(edges, "critical_gain", lambda *_: TwinEdge(1.0, 1.0, 5.0, 1e-3))
    base = figure_edges.rig().model_dump(mode="json")
    for point in edges.edge_points([0.3, 0.4], sizes=(2e-3, -2e-3)):
        assert edges.edge_of(point, base)["theory"] == {"rest": [1.0, "flip", 5.0]}
    assert counted == [0.3, 0.4]
