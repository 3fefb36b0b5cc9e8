"""Figures 2.23, 2.25 to 2.27: what they show, by their numbers."""

import numpy as np
import pytest

from bridge.figures.lines import characteristics as lines_characteristics
from bridge.figures.lines.friction import CASE, SPAN
from bridge.figures.lines.orders import (
    HELD,
    run,
    smooth,
    steep,
)
from twin.lines.lab.exact import exact_history
from twin.lines.lab.peaks import peaks_of


def test_characteristics_with_half_steps_damp():
    """2.23: whole steps swing between 9.12 and 10.88 bar for ever, interpolated ones lose height and slope."""
    table = lines_characteristics.columns()
    whole, half = table["inlet pressure at Courant 1 [Pa]"], table["inlet pressure at Courant 0.5 [Pa]"]
    assert set(np.round(1e-5 * whole, 5)) == {10.87656, 9.12344}
    late = table["time [s]"] > 0.04
    assert half[late].max() < whole.max() - 0.05e5
    assert np.abs(np.diff(half)).max() < 0.2 * np.abs(np.diff(whole)).max()


@pytest.mark.parametrize("wave", [smooth, steep])
def test_high_orders_pay(wave):
    """2.25, 2.26 at 40 cells: backward Euler the worst, cds5 the best of equal steps, Chebyshev the best of all."""
    error = {(space, time): run(wave, space, time, 40).error for space in ("cds3", "cds5", "fem", "chebyshev")
             for time in ("backward-euler", "esdirk3", "esdirk4")}  # fmt: skip
    for space in ("cds3", "cds5", "fem", "chebyshev"):
        assert error[space, "backward-euler"] > 1.5 * error[space, "esdirk4"]
    assert error["cds5", "esdirk4"] < error["fem", "esdirk4"] < error["cds3", "esdirk4"]
    assert error["chebyshev", "esdirk4"] < 0.05 * error["cds5", "esdirk4"]


def test_ends_held_over_the_step_hide_all_differences():
    """The thesis's picture: whatever the space, the same 16 % at 40 cells; FEM looks no worse than any."""
    found = [run(smooth, space, HELD, 40).error for space in ("cds3", "cds5", "fem", "chebyshev")]
    assert found == pytest.approx([0.155] * 4, rel=0.05)


def test_errors_do_not_grow_with_time_where_waves_leave():
    """Driven ends: ten periods err like two."""
    few, many = run(smooth, "fem", "esdirk4", 40, 2.0).error, run(smooth, "fem", "esdirk4", 40, 10.0).error
    assert many == pytest.approx(few, rel=0.1)


def test_water_hammer_of_the_source():
    """2.27, tenth peak over the outlet: 1.319 bar frictionless, 0.08 less quasi-steady, 0.52 less with memory."""
    found = {kind: peaks_of(CASE, exact_history(CASE, kind, SPAN, 20000)) for kind in ("none", "steady", "unsteady")}
    amplitude = {kind: 1e-5 * peaks.amplitude[9] for kind, peaks in found.items()}
    assert amplitude == pytest.approx({"none": 1.319, "steady": 1.233, "unsteady": 0.797}, abs=0.003)
    assert 10e-3 < found["unsteady"].end[9] - found["none"].end[9] < 13e-3  # memory is mass
