"""Steady relief valve: the table of the corrected equations, an independent scipy solution, and inverses."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.relief_valve import (
    BAR,
    FLOW,
    LITRE_PER_MINUTE,
    PRECOMPRESSION,
    PRESSURE,
    bracketed,
    valve,
)
from twin.relief.poppet import cracking_pressure
from twin.relief.steady import (
    precompression_for,
    rest,
    steady_flow,
    steady_pressure,
    steady_slope,
)
from twin.relief.valve import SHUT

VALVE = valve()
FLOWS = (0.1, 1.0, 10.0, 25.0, 50.0, 100.0, 200.0)
TABLE = {
    0.2e-3: (65.854, 71.972, (68.167, 71.994, 72.239, 72.638, 73.278, 74.480, 76.631)),
    1.0e-3: (329.272, 333.744, (330.747, 333.779, 334.179, 334.832, 335.886, 337.899, 341.656)),
}


def by_scipy(pressure: float, precompression: float) -> float:
    """Q of the steady equations, written out again from its numbers alone."""
    rho, nu, a_in, a_sp = 878.0, 40e-6, math.pi / 4 * 5.6e-3**2, math.pi / 4 * 26e-3**2
    holes = ((0.6e-3, 0.61, 9.33), (0.8e-3, 0.86, 30.0))
    areas = [math.pi / 4 * d**2 for d, _, _ in holes]
    square = [rho / (2 * (c * a) ** 2) for (_, c, _), a in zip(holes, areas, strict=True)]
    line = sum(s * a * nu * re / d for s, a, (d, _, re) in zip(square, areas, holes, strict=True))

    def cone(x: float, d: float, degrees: float) -> float:
        return math.pi * x * math.sin(math.radians(degrees)) * (d - x / 2 * math.sin(math.radians(2 * degrees)))

    def pilot_flow(x: float) -> tuple[float, float]:
        per_square = rho / 2 * 0.369 * (5.6e-3 / x) ** 2.3 / a_in**2
        flow = bracketed(lambda q: (sum(square) + per_square) * q**2 + line * q - pressure, 0.0, 1.0)
        return flow, per_square * flow**2

    def pilot_balance(x: float) -> float:
        flow, p2 = pilot_flow(x)
        momentum = rho * flow**2 * (1 / a_in - math.cos(math.radians(21)) / cone(x, 5.6e-3, 21.0))
        return momentum + a_in * p2 - 811e3 * (precompression + x)

    flow, p2 = pilot_flow(bracketed(pilot_balance, 1e-9, 3e-3))

    def spool_balance(x: float) -> float:
        a = cone(x, 26e-3, 45.0) / a_sp
        lift = pressure * a_sp * (1 + 2 * 0.61**2 * a * (a - math.cos(math.radians(45))))
        return lift - p2 * a_sp - 27.3e3 * (5e-3 + x)

    if spool_balance(0.0) <= 0.0:
        return flow
    x = bracketed(spool_balance, 0.0, 4e-3)
    return flow + 0.61 * cone(x, 26e-3, 45.0) * math.sqrt(2 * pressure / rho)


@pytest.mark.parametrize("precompression", TABLE)
def test_the_static_curve_is_the_corrected_table(precompression: float):
    v, (crack, knee, row) = valve(pilot_precompression=precompression), TABLE[precompression]
    assert cracking_pressure(v.pilot) / BAR == pytest.approx(crack, abs=5e-4)
    assert steady_pressure(0.22507 * LITRE_PER_MINUTE, v) / BAR == pytest.approx(knee, abs=1e-3)
    pressures = [steady_pressure(q * LITRE_PER_MINUTE, v) / BAR for q in FLOWS]
    assert pressures == pytest.approx(row, abs=5.01e-4)


@pytest.mark.parametrize("precompression", TABLE)
def test_the_main_stage_opens_at_0_22507_l_per_min_of_the_pilot(precompression: float):
    v = valve(pilot_precompression=precompression)
    below, above = (rest(steady_pressure(q * LITRE_PER_MINUTE, v), v) for q in (0.22506, 0.22508))
    assert below.spool_lift == 0.0 < above.spool_lift


@given(st.floats(66.0, 78.0))
def test_the_flow_is_that_of_an_independent_solution(bar: float):
    v = valve(pilot_precompression=0.2e-3)
    assert steady_flow(bar * BAR, v) == pytest.approx(by_scipy(bar * BAR, 0.2e-3), rel=1e-7)


def test_the_poppet_lift_at_70_bar_is_the_root_that_iteration_misses():
    """The thesis's function iteration cycles between 12.4 and 1.6 um there."""
    assert rest(70 * BAR, valve(pilot_precompression=0.2e-3)).pilot_lift == pytest.approx(8.123e-6, abs=5e-10)


def test_nothing_is_open_up_to_the_cracking_pressure():
    crack = cracking_pressure(VALVE.pilot)
    for pressure in (-BAR, 0.0, crack):
        assert rest(pressure, VALVE) == SHUT
        assert steady_flow(pressure, VALVE) == steady_slope(0.5 * pressure, VALVE) == 0.0


@given(st.floats(0.001, 900.0))
def test_pressure_and_flow_are_inverse(litres: float):
    flow = litres * LITRE_PER_MINUTE
    assert steady_flow(steady_pressure(flow, VALVE), VALVE) == pytest.approx(flow, rel=1e-8)


@pytest.mark.parametrize("litres", [0.05, 0.2, 1.0, 26.7, 100.0])
def test_the_slope_is_that_of_the_curve(litres: float):
    """Against a secant of the inverse, 0.1 % of the flow wide: a way to it that shares no difference."""
    flow = litres * LITRE_PER_MINUTE
    below, above = steady_pressure(0.9995 * flow, VALVE), steady_pressure(1.0005 * flow, VALVE)
    assert steady_slope(steady_pressure(flow, VALVE), VALVE) == pytest.approx(1e-3 * flow / (above - below), rel=1e-4)


@pytest.mark.parametrize("bar", [20.0, 67.0, 150.0, 300.0])
def test_the_precompression_holds_the_setting(bar: float):
    held = valve(pilot_precompression=precompression_for(bar * BAR, FLOW, VALVE))
    assert steady_flow(bar * BAR, held) == pytest.approx(FLOW, rel=1e-9)


def test_the_rig_is_set_to_67_bar_at_26_7_l_per_min():
    assert precompression_for(PRESSURE, FLOW, VALVE) == pytest.approx(PRECOMPRESSION, rel=1e-12)


def test_a_setting_below_the_spool_spring_is_refused():
    with pytest.raises(ValueError, match=r"cannot hold 200000.0 Pa .* take a higher setting or less flow"):
        precompression_for(2 * BAR, FLOW, VALVE)
