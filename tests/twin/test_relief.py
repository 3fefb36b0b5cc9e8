"""Dynamic relief valve: what it does when shut, opening, at work, closing, and at its stops."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.relief_valve import (
    BAR,
    FLOW,
    IMPEDANCE,
    LITRE_PER_MINUTE,
    PRESSURE,
    run,
    steadily,
    valve,
)
from twin.relief.poppet import cracking_pressure
from twin.relief.steady import precompression_for, rest, steady_pressure
from twin.relief.valve import SHUT, Relief, relieve

VALVE = valve()
CRACK = cracking_pressure(VALVE.pilot)
LINE = PRESSURE + IMPEDANCE * FLOW  # c that drives 26.7 l/min through the valve
PILOT_LIFT, SPOOL_LIFT, SPOOL_SPEED, Q, P = 0, 2, 3, 4, 5


def set_to(bar: float) -> Relief:
    return valve(pilot_precompression=precompression_for(bar * BAR, FLOW, VALVE))


def frequency(x: np.ndarray, step: float) -> float:
    """[Hz] of a swing about its mean, from the first to the last upward crossing."""
    x = x - 0.5 * (x.max() + x.min())
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    crossings = up + x[up] / (x[up] - x[up + 1])
    return float((len(crossings) - 1) / ((crossings[-1] - crossings[0]) * step))


@given(st.floats(-1e7, CRACK), st.floats(-1e7, CRACK), st.floats(0.0, 1e11))
def test_a_shut_valve_stays_exactly_shut(before: float, after: float, z: float):
    assert relieve(SHUT, before, after, z, 0.0, VALVE, 50e-6) == (SHUT, 0.0, after, 0)


def test_it_opens_on_the_first_pressure_above_cracking():
    rows = run(VALVE, lambda t: CRACK * (1.0 + 1e-3 * (t - 10e-3) / 10e-3), 20e-3)
    assert not rows[:200].any(where=[True] * 5 + [False] * 2)
    assert rows[-1, PILOT_LIFT] > 0.0


@pytest.mark.parametrize(("bar", "milliseconds"), [(67.0, 9.9), (150.0, 5.85), (300.0, 3.8)])
def test_after_a_step_it_opens_without_overshoot_of_its_flow(bar: float, milliseconds: float):
    """90 % of 26.7 l/min; orifice 3 holds the spool back, the lines' pressure peaks meanwhile."""
    rows = run(set_to(bar), steadily(bar * BAR + IMPEDANCE * FLOW), 40e-3)
    assert 0.05 * (1 + np.argmax(rows[:, Q] > 0.9 * FLOW)) == pytest.approx(milliseconds, abs=0.051)
    assert rows[:, Q].max() < 1.005 * FLOW
    assert rows[:, P].max() > bar * BAR + 0.9 * IMPEDANCE * FLOW
    assert rows[-1, Q] == pytest.approx(FLOW, rel=5e-3)


def test_at_67_bar_it_settles_without_chatter():
    rows = run(VALVE, steadily(LINE), 150e-3)
    assert np.ptp(rows[-200:, P]) < 1.0  # Pa
    assert rows[-1, P] == pytest.approx(PRESSURE, abs=1.0)


@pytest.mark.parametrize("bar", [67.0, 150.0, 300.0])
@pytest.mark.parametrize("litres", [1.0, 5.0, 26.7, 100.0])
def test_the_mean_flow_is_the_steady_one(bar: float, litres: float):
    """To 0.25 %: at 150 and 300 bar the pilot keeps swinging, and a swing shifts the mean of a curved law."""
    v, flow = set_to(bar), litres * LITRE_PER_MINUTE
    start, p = steady_pressure(1.1 * flow, v), steady_pressure(flow, v)
    rows = run(v, steadily(p + IMPEDANCE * flow), 0.2, s=rest(start, v), flow=1.1 * flow)
    assert rows[-1000:, Q].mean() == pytest.approx(flow, rel=2.5e-3)  # 0.21 % at steps of 5 us
    assert rows[-1000:, P].mean() == pytest.approx(p, rel=1e-5)


@pytest.mark.parametrize("litres", [0.1, 1.0, 26.7, 100.0])
@pytest.mark.parametrize("z", [0.0, 5e9, 1e11])
def test_a_steady_state_is_a_state_of_rest(litres: float, z: float):
    flow = litres * LITRE_PER_MINUTE
    p = steady_pressure(flow, VALVE)
    rows = run(VALVE, steadily(p + z * flow), 0.5e-3, s=rest(p, VALVE), flow=flow, z=z)
    assert rows[-1, [PILOT_LIFT, SPOOL_LIFT]] == pytest.approx(rest(p, VALVE)[::2], rel=1e-6)
    assert rows[-1, Q] == pytest.approx(flow, rel=1e-6)


def test_the_free_poppet_swings_at_1392_hz():
    """Orifices so wide that p2 does not react; 3.3 bar hold it 10 um open. Flow forces stiffen it by 0.1 %."""
    v = valve(orifice_diameter=20e-3, nozzle_diameter=20e-3, pilot_precompression=0.0)
    at = rest(3.3 * BAR, v)
    rows = run(v, steadily(3.3 * BAR), 50e-3, s=at._replace(pilot_lift=1.2 * at.pilot_lift), z=0.0, step=5e-6)
    assert frequency(rows[:, PILOT_LIFT], 5e-6) == pytest.approx(1392.12, rel=1e-3)


def test_the_free_poppet_dies_away_by_the_drag_on_its_spring():
    """K/(2 m) = 1.01 1/s, printed as poor damping."""
    v = valve(orifice_diameter=20e-3, nozzle_diameter=20e-3, pilot_precompression=0.0)
    at = rest(3.3 * BAR, v)
    rows = run(v, steadily(3.3 * BAR), 0.2, s=at._replace(pilot_lift=1.2 * at.pilot_lift), z=0.0, step=5e-6)
    early, late = (np.ptp(rows[k : k + 2000, PILOT_LIFT]) for k in (0, 38000))
    assert math.log(early / late) / 0.19 == pytest.approx(0.5 * v.pilot.drag / v.pilot.mass, rel=0.05)


def test_the_free_spool_swings_at_103_hz():
    """Orifices so wide that no pressure acts on it, its spring at rest 2 mm open."""
    v = valve(orifice_diameter=30e-3, nozzle_diameter=30e-3, spool_precompression=-2e-3)
    rows = run(v, steadily(0.0), 0.1, s=SHUT._replace(spool_lift=2.5e-3), z=0.0, step=20e-6)
    assert frequency(rows[:, SPOOL_LIFT], 20e-6) == pytest.approx(102.907, rel=2e-3)  # zeta 1.4 %, and wide is not free


def test_orifice_3_overdamps_the_spool_and_times_its_closing():
    """With the pilot shut, s (x0 + x)/A drives the oil that the spool needs through orifices 1, 2, 3: x' = -Q/A."""
    main, o = VALVE.main, VALVE.orifices
    rows = run(VALVE, steadily(0.0), 40e-3, s=SHUT._replace(spool_lift=0.1e-3), z=0.0)
    lifts = np.linspace(0.0, 0.1e-3, 201)
    a, b = o.a_12 + o.a_3, o.b_12 + o.b_3
    flows = (-b + np.sqrt(b**2 + 4 * a * (main.preload + main.stiffness * lifts) / main.area)) / (2 * a)
    duration = np.trapezoid(main.area / flows, lifts)  # 18.8 ms
    shut = np.flatnonzero(rows[:, SPOOL_LIFT] == 0.0)[0]
    assert shut * 50e-6 == pytest.approx(duration, abs=100e-6)
    assert (rows[:shut, SPOOL_SPEED] < 0.0).all()
    assert not rows[shut + 1 :, :Q].any()


@pytest.mark.parametrize(("bar", "milliseconds"), [(67.0, 19.35), (150.0, 12.85), (300.0, 8.95)])
def test_it_closes_in_the_time_stated(bar: float, milliseconds: float):
    v = set_to(bar)
    rows = run(v, steadily(0.5 * bar * BAR), 40e-3, s=rest(bar * BAR, v), flow=FLOW)
    assert 0.05 * (1 + np.argmax(rows[:, SPOOL_LIFT] == 0.0)) == pytest.approx(milliseconds, abs=0.051)
    assert not rows[-1, :P].any()


def test_at_very_large_flow_the_spool_rests_on_its_stop():
    rows = run(VALVE, steadily(200 * BAR), 0.1, z=1e7)
    assert (rows[-10:, SPOOL_LIFT] == VALVE.main.stops.stroke).all()
    assert not rows[-10:, SPOOL_SPEED].any()


@pytest.mark.parametrize("step", [50e-6, 100e-6])
def test_pump_ripple_takes_one_substep_and_0_01_bar(step: float):
    """3 % at 184 Hz, against steps of 1 us."""

    def ripple(t: np.ndarray) -> np.ndarray:
        return PRESSURE + IMPEDANCE * FLOW * (1.0 + 0.03 * np.sin(2 * math.pi * 184 * t))

    coarse = run(VALVE, ripple, 40e-3, s=rest(PRESSURE, VALVE), flow=FLOW, step=step)
    fine = run(VALVE, ripple, 40e-3, s=rest(PRESSURE, VALVE), flow=FLOW, step=1e-6)
    skip = round(step / 1e-6)
    assert np.abs(coarse[:, P] - fine[skip - 1 :: skip, P]).max() < 0.01 * BAR
    assert (coarse[:, -1] == 1).all()
