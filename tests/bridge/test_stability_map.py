"""Charts over any two numbers of a loop: every cell is the loop of its own numbers, whatever goes in one stack."""

from pathlib import Path

import numpy as np
import pytest

from bridge.errors import RunError
from bridge.scenario import load
from bridge.studies.stability.chart import (
    AXES,
    Family,
    OfRig,
    Plainly,
    chart,
)
from bridge.studies.stability.map import Wanted, make
from bridge.studies.stability.rig_loop import loop_of
from bridge.studies.stability.watched_theory import Watch
from controller.stability import Timing, closed, monodromy, multipliers, stable_count

FILTERED = Plainly({"damping": 0.1, "delay": 0.6}, "filtered", 0.7)
SPANS = {"gain": (0.0, 4.0), "derivative": (0.0, 1.0), "period": (0.5, 9.0), "delay": (0.0, 2.7), "damping": (0.0, 1.0)}


@pytest.mark.parametrize("up", AXES)
@pytest.mark.parametrize("across", AXES)
def test_a_dimensionless_cell_is_a_monodromy_matrix(across: str, up: str):
    if across == up:
        return
    x, y = np.linspace(*SPANS[across], 3), np.linspace(*SPANS[up], 5)
    drawn = chart(FILTERED, across, up, x, y)
    for i, j in np.ndindex(drawn.outside.shape):
        at = {**FILTERED.numbers, across: float(x[j]), up: float(y[i])}
        s, d, k, gamma = (at[name] for name in ("gain", "derivative", "damping", "gamma"))
        matrix = monodromy(s, d, k, gamma, Timing(at["period"], at["delay"], "filtered", 0.7))
        assert (drawn.total[i, j], drawn.outside[i, j]) == (len(matrix), len(matrix) - stable_count(matrix))
        size = np.abs(multipliers(matrix))
        assert drawn.excess[i, j] == pytest.approx(size.max() - 1.0, abs=1e-9)


@pytest.mark.parametrize("velocity", ["measured", "filtered"])
@pytest.mark.parametrize("up", ["gain", "period", "delay", "damping"])
def test_a_cell_of_a_rig_is_its_own_loop(velocity: str, up: str):
    """V/%, ms and N s/m there, SI here: 10 V and 270 mm make 37.037 1/m of 1 V/%."""
    scenario = load("slow-sampling", [f"controller.velocity={velocity}", "controller.filter_time=0.05"])
    family: Family = OfRig(scenario, "up")
    spans = {"gain": (0.1, 2.0), "period": (40.0, 200.0), "delay": (0.0, 150.0), "damping": (0.0, 2000.0)}
    across = "gain" if up != "gain" else "period"
    x, y = np.linspace(*spans[across], 2), np.linspace(*spans[up], 3)
    drawn = chart(family, across, up, x, y)
    assert isinstance(family, OfRig)
    for i, j in np.ndindex(drawn.outside.shape):
        at = {**family.numbers, across: float(x[j]), up: float(y[i])}
        timing = family.timing._replace(period=1e-3 * at["period"], delay=1e-3 * at["delay"])
        matrix = closed(loop_of(family.about_point.plant(at["damping"]), timing), at["gain"] / 0.027, 0.0)
        assert drawn.outside[i, j] == len(matrix) - stable_count(matrix)
        assert drawn.excess[i, j] == pytest.approx(np.abs(multipliers(matrix)).max() - 1.0, abs=1e-6)


def test_both_axes_must_differ_and_exist():
    with pytest.raises(ValueError, match="both axes are 'gain'"):
        chart(FILTERED, "gain", "gain", np.ones(1), np.ones(1))
    with pytest.raises(ValueError, match=r"axis 'mass' is unknown \(valid: gain, derivative"):
        chart(FILTERED, "mass", "gain", np.ones(1), np.ones(1))


def test_a_chart_that_is_stopped_has_the_columns_that_are_there():
    x, y = np.linspace(0.5, 9.0, 9), np.linspace(0.0, 4.0, 5)
    whole = chart(FILTERED, "period", "gain", x, y)
    part = chart(FILTERED, "period", "gain", x, y, lambda done: done < 4)
    assert (part.x == x[:4]).all()
    for mine, all_of_them in zip(part[4:8], whole[4:8], strict=True):
        assert (mine == all_of_them[:, :4]).all()


def test_a_long_chart_is_told_and_an_interrupted_one_is_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """1000 columns of 0.1 s each: 100 s, and 10 s for a side of sqrt(10 s/100 s); the time goes with the area."""
    said, now = [], [0.0]
    watch = Watch(1000, lambda: now[0] > 2.0, lambda: None, said.append, lambda: now[0])
    asked = []
    for done in range(40):
        now[0] = 0.1 * done
        asked.append(watch(done))
    assert asked.index(False) == 21
    assert said == [
        "theory of 1000 columns takes some 100 s here; Ctrl-C draws what is there, and --cells 320 takes some 10 s"
    ]
    monkeypatch.setattr(Watch, "__call__", lambda self, done: done < 5)
    wanted = Wanted("period", "gain", None, None, None, "", (), (), 20, 8, False, "measured", None)
    with pytest.raises(RunError, match=r"interrupted at period 4\.289 of 20, 5 of 20 columns: .*map\.png"):
        make(wanted, tmp_path / "map", 1, None)
    assert (tmp_path / "map.csv").read_text(encoding="utf-8").count("\n") == 1 + 5 * 20
    assert {path.name for path in tmp_path.iterdir()} == {"map.png", "map.csv", "map.html"}
