"""Figures of the thesis, drawn from the twin: what the measurements on it must give back."""

import csv
import math
import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from bridge.errors import UsageError
from bridge.figures.catalogue import FIGURES, LONG, draw_figure
from bridge.figures.friction.constant_speed import (
    LOADS,
    OUT_OF_RANGE,
    SAMPLE,
    SAMPLES,
    SPREAD,
    STEADY,
    STEP,
    Readings,
    readings,
    runs,
)
from bridge.figures.friction.friction import rig_seal
from bridge.figures.friction.power_law import (
    PowerLaw,
    factor,
    fit_power_law,
    law_force,
    limited,
    on_slope,
)
from bridge.figures.oil.viscosity import (
    REFERENCE,
    THERMOMETER,
    Points,
    constants,
    fit,
    measure,
    viscosity_columns,
)
from twin.oil import exponential_viscosity, kinematic_viscosity
from twin.rig import rig_number
from twin.seal import friction

ALPHA, BETA = rig_number("seal", "alpha"), rig_number("seal", "beta")


@pytest.fixture(scope="module")
def exact() -> Readings:
    """The friction test without the card: the true values."""
    return readings(carded=False)


@pytest.fixture(scope="module")
def carded() -> Readings:
    """The friction test as the 12-bit card reads it."""
    return readings()


def exact_points(law) -> Points:
    return measure(law, thermometer=0.0, stop_watch=0.0)


@pytest.mark.parametrize(
    ("name", "nearest"),
    [("2.3", "; did you mean '2.30'?"), ("24", "; did you mean '2.4'?"), ("viscosity", " (valid: 2.2, 2.4, 2.5, 2.6")],
)
def test_an_unknown_figure_is_refused_with_the_nearest(tmp_path: Path, name: str, nearest: str):
    with pytest.raises(UsageError, match=re.escape(f"no figure '{name}'{nearest}")):
        draw_figure(name, tmp_path / "none")
    assert not (tmp_path / "none").exists()


def module(name: str) -> str:
    """The module that draws a figure."""
    return FIGURES[name].source.rpartition(".")[0]


ELSEWHERE = (
    "rig-friction",
    "coupled-line",
    "chatter-spectrum",
    "2.25",
    "2.26",
    "5.4",
    "5.7",
)  # which take long; tests of their numbers compute them anyway
FIRST = {module(name): name for name in reversed(FIGURES) if name not in (*LONG, *ELSEWHERE)}


def marks(name: str):
    """Of the figures of a module one is drawn here; the others are for the long trials."""
    return () if name == FIRST.get(module(name)) else (pytest.mark.endurance, pytest.mark.timeout(900))


def test_every_figure_names_a_function_that_is_there():
    for figure in FIGURES.values():
        module, _, function = figure.source.rpartition(".")
        assert callable(getattr(import_module(f"bridge.figures.{module}"), function)), figure.name


@pytest.mark.parametrize("name", [pytest.param(name, marks=marks(name)) for name in FIGURES])
def test_a_figure_is_a_picture_and_a_table_with_units(tmp_path: Path, name: str):
    picture, table = draw_figure(name, tmp_path / "made")
    assert (picture.name, table.name) == (f"{name}.png", f"{name}.csv")
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert picture.stat().st_size > 20_000
    with table.open(newline="") as file:
        header, *rows = csv.reader(file)
    assert all(re.fullmatch(r"[^\[\],]+ \[[^\[\],]+\]", column) for column in header)
    assert np.isfinite(np.array(rows, float)).all()
    assert len(rows) >= 9


def test_a_table_is_the_same_at_every_run(tmp_path: Path):
    first = draw_figure("2.2", tmp_path / "a")[1].read_bytes()
    assert first == draw_figure("2.2", tmp_path / "b")[1].read_bytes()


def test_exact_falls_give_the_second_order_law_back():
    found = constants(fit(exact_points(kinematic_viscosity)))
    assert found["second order nu_0 [m^2/s]"] == pytest.approx(117.95e-6, rel=1e-9)
    assert found["second order lambda_1 [1/degC]"] == pytest.approx(0.0608, rel=1e-9)
    assert found["second order lambda_2 [1/degC^2]"] == pytest.approx(3.45e-4, rel=1e-9)


def test_exact_falls_in_oil_of_first_order_give_walds_constants_back():
    found = constants(fit(exact_points(exponential_viscosity), 0.0, 0.0))
    assert found["first order nu_0 [m^2/s]"] == pytest.approx(92.79e-6, rel=1e-9)
    assert found["first order lambda [1/degC]"] == pytest.approx(0.0401, rel=1e-9)
    assert found["first order lambda deviation [1/degC]"] == 0.0


def test_wald_bends_the_second_order_law_to_the_secant_of_its_halves():
    """Means of theta and theta^2 over 25..45 and 50..75 deg C: 15 and 275, 42.5 and 11275/6; T_0 = 20 deg C."""
    secant = 0.0608 - 3.45e-4 * (11275.0 / 6.0 - 275.0) / (42.5 - 15.0)
    assert fit(exact_points(kinematic_viscosity)).first.slope == pytest.approx(-secant, rel=1e-9)


def test_the_seeded_measurement_lies_near_the_laws():
    """Three standard deviations of Wald's slope, from a thermometer of 0.5 deg C."""
    laws, true = fit(measure()), fit(exact_points(kinematic_viscosity))
    assert laws.first.slope == pytest.approx(true.first.slope, abs=3.0 * laws.first.slope_deviation)
    assert laws.first.slope == pytest.approx(-0.0401, rel=0.05)  # the thesis's points are not ours
    shown = measure().temperature - measure(thermometer=0.0).temperature
    assert 0.0 < np.abs(shown).max() < 4.0 * THERMOMETER / math.sqrt(3.0)


def test_the_viscosity_table_holds_the_fitted_curve_of_its_own_constants():
    table = viscosity_columns()
    theta = table["temperature [degC]"] - REFERENCE
    curve = table["first order nu_0 [m^2/s]"] * np.exp(-table["first order lambda [1/degC]"] * theta)
    assert table["first order fitted [m^2/s]"] == pytest.approx(curve, rel=1e-12)


def test_friction_at_constant_speed_is_the_law(exact: Readings):
    """Less the inertia of what the speed changes over a window. 0.3 %: a speed that still swings by up to 1 % is seen
    in broken periods, at 5 ms, and its friction by a falling curve. 0.3 N: so is the inertia of the swing, which does
    not fall with the friction; 334 kg, 1 % of 30 mm/s at 10 Hz are 6 N."""
    seal, steady = rig_seal(), exact.steady
    change = np.array([run.taps[-1, 1, 1] - run.taps[0, 1, 1] for run in runs()])
    force = exact.force - exact.mass * change / ((SAMPLES - 1) * SAMPLE * STEP)
    law = [friction(v, p, seal)[0] * math.copysign(1.0, v) for v, p in zip(exact.speed, exact.sealing, strict=True)]
    assert force[steady] == pytest.approx(np.array(law)[steady], rel=3e-3, abs=0.3)
    calm = steady & (exact.spread < 1e-5 * np.abs(exact.speed))  # its inertia is some 1e-5 of the least friction
    assert calm.sum() >= 20
    assert exact.force[calm] == pytest.approx(law_force(exact.speed, exact.sealing, seal)[calm], rel=2e-5)


def test_the_test_covers_all_loads_both_ways_and_the_limit(exact: Readings):
    for mass in LOADS:
        for sign in (1.0, -1.0):
            moving = exact.steady & (exact.mass == mass) & (sign * exact.speed > 0.01)
            assert moving.sum() >= 3, (mass, sign)
    z, g = factor(exact, rig_seal())
    plateau = exact.steady & (np.abs(z) < rig_seal().plateau)
    assert plateau.any()
    swing = exact.spread[plateau] / np.abs(exact.speed[plateau])  # means of a swing err by its square
    assert (np.abs(np.abs(g[plateau]) / rig_number("seal", "limit") - 1.0) < np.maximum(1e-6, swing**2)).all()


def test_exact_readings_give_the_power_law_back(exact: Readings):
    """alpha is g extrapolated from z = 3e-8 to 1: an error of beta comes back as some 17 times that in ln alpha."""
    law = fit_power_law(exact, rig_seal())
    assert law.beta == pytest.approx(BETA, abs=5e-4)
    assert law.alpha == pytest.approx(ALPHA, rel=17.0 * 5e-4)


def test_the_card_gives_the_power_law_back(carded: Readings):
    """The mean of 80 dithered readings errs by 0.4 kPa, 1 % of the least friction, at one end of a decade of z."""
    seal = rig_seal()
    law, used = fit_power_law(carded, seal), on_slope(carded, seal)
    assert law.beta == pytest.approx(BETA, abs=0.01)
    z = factor(carded, seal)[0][used]
    true = limited(z, PowerLaw(ALPHA, BETA), seal.limit)
    assert limited(z, law, seal.limit) == pytest.approx(true, rel=0.01)


def test_runs_left_out_are_kept_and_named(exact: Readings, carded: Readings):
    unsteady = exact.spread > SPREAD * np.abs(exact.speed)
    assert (exact.verdict[unsteady] != STEADY).all()
    assert unsteady.any()
    vacuum = exact.steady & (exact.p_upper < 0.0)
    assert vacuum.any()
    assert (carded.verdict[vacuum] == OUT_OF_RANGE).all()
    assert len(exact.speed) == len(carded.speed)
