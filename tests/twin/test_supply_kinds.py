"""Supplies beside the gear pump: characteristics in closed form, the swash plate against Radau, what a port sees."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.fixed_pump import delivery_pressure, displaced_oil
from twin.integration import integrate
from twin.kernel import interpreted, kernel
from twin.lag import lag_over
from twin.oil import Oil
from twin.port import Port
from twin.pressure_source import PressureSource, sourced
from twin.variable_pump import VariablePump, steady_variable, variable_flow, wanted_displacement

BAR = 1e5
OIL = Oil(870.0, 40e-6, 1.3e9, -1e5)
CAPACITY = 2e-3 / 1.3e9  # of two litres
LEAK = 1e-12


def variable(step: float, time: float = 30e-3, least: float = 0.1, leakage: float = LEAK) -> VariablePump:
    """30 l/min, cut off at 100 bar, down to a tenth 5 bar above."""
    return VariablePump(5e-4, least, 100 * BAR, 5 * BAR, leakage, time, lag_over(time / step), 0.0)


@kernel
def fed(pump: VariablePump, oil: Oil, capacity: float, conductance, step: float, p: float, displacement, out) -> None:
    """A volume between the pump and a conductance to the tank at each instant, by the trapezoidal rule."""
    displacement[0] = wanted_displacement(p, pump)
    q = displaced_oil(p, pump.delivery * displacement[0], -pump.leakage, oil)[0]
    for i in range(len(out)):
        half = 0.5 * step / capacity
        share = 1.0 + half * conductance[i + 1]
        port = Port((p + half * (q - conductance[i] * p)) / share, half / share)
        q = variable_flow(i + 1.0, port, p, displacement, pump, oil, step)
        p = port.free + port.impedance * q
        out[i, 0], out[i, 1] = p, displacement[0]


def opened_and_shut(times: np.ndarray) -> np.ndarray:
    """A conductance [m^3/(s Pa)] that goes down and up again within 0.4 s, smoothly."""
    return 3e-11 + 1.5e-11 * np.cos(5.0 * math.pi * times)


def run(step: float, start: float) -> np.ndarray:
    out = np.zeros((round(0.4 / step), 2))
    times = step * np.arange(len(out) + 1)
    fed(variable(step), OIL, CAPACITY, opened_and_shut(times), step, start, np.zeros(12), out)
    return out


def exact(start: float) -> np.ndarray:
    """The same by the equations as printed in `variable_pump.py`, every 10 ms."""
    d, least, cut, droop = 5e-4, 0.1, 100 * BAR, 5 * BAR

    def u(p: float) -> float:
        return float(np.clip(1.0 - (1.0 - least) * (p - cut) / droop, least, 1.0))

    def rates(t: float, y: np.ndarray) -> list[float]:
        p, s = y[0] * BAR, y[1]
        q = (1.0 + p / OIL.bulk_modulus) * (d * s - LEAK * p) - float(opened_and_shut(np.array(t))) * p
        return [q / CAPACITY / BAR, (u(p) - s) / 30e-3]

    first = [start / BAR, u(start)]
    times = np.arange(1, 41) * 10e-3
    found = integrate(rates, (0.0, 0.4), first, "Radau", t_eval=times, rtol=1e-9, atol=1e-11, most=60000)
    return found.y.T * [BAR, 1.0]


def test_swash_plate_and_volume_agree_with_radau():
    """A load that comes and goes takes the pump off its stop and back: within 0.01 bar at 50 us."""
    reference, found = exact(95 * BAR), run(50e-6, 95 * BAR)[199::200]
    assert reference[:, 1].min() < 0.5
    assert reference[:, 1].max() > 0.99
    assert np.abs(found[:, 0] - reference[:, 0]).max() < 0.01 * BAR
    assert np.abs(found[:, 1] - reference[:, 1]).max() < 1e-3


def test_the_step_is_of_second_order_while_the_swash_plate_is_on_its_way():
    """Within the droop throughout, 60 ms of a load that changes: halving the step divides the error by four."""

    def end(step: float) -> float:
        out = np.zeros((round(60e-3 / step), 2))
        times = step * np.arange(len(out) + 1)
        load = 3e-11 + 1e-11 * np.sin(30.0 * times)
        fed(variable(step), OIL, CAPACITY, load, step, 102 * BAR, np.zeros(12), out)
        assert 100 * BAR < out[:, 0].min() < out[:, 0].max() < 105 * BAR
        return float(out[-1, 0])

    ends = [end(step) for step in (2e-3, 1e-3, 0.5e-3)]
    assert math.log2((ends[0] - ends[1]) / (ends[1] - ends[2])) == pytest.approx(2.0, abs=0.15)


def test_a_jump_of_pressure_moves_the_swash_plate_by_the_exponential():
    """Held at 110 bar from 90 bar on: s = s_min + (1 - s_min) e^(-t/T), whatever the step."""
    for step in (50e-6, 5e-3):
        pump, memory, function = variable(step), np.ones(12), interpreted(variable_flow)
        stiff = Port(110 * BAR, 1e-6)
        for k in range(1, 9):
            function(float(k), stiff, 110 * BAR, memory, pump, OIL, step)
            assert memory[0] == pytest.approx(0.1 + 0.9 * math.exp(-k * step / 30e-3), rel=1e-12)


@pytest.mark.parametrize(
    ("bar", "share"), [(0.0, 1.0), (100.0, 1.0), (101.0, 0.82), (102.5, 0.55), (105.0, 0.1), (300.0, 0.1)]
)
def test_static_characteristic_has_the_stated_droop_and_limits(bar: float, share: float):
    """All of it to the cut-off, a tenth from 5 bar above on, straight between; less the leak, times the density."""
    flow, slope = interpreted(steady_variable)(bar * BAR, 1.0, variable(50e-6), OIL)
    p = bar * BAR
    assert flow == pytest.approx((1.0 + p / 1.3e9) * (5e-4 * share - LEAK * p), rel=1e-12)
    if bar not in (100.0, 105.0):
        above, below = (interpreted(steady_variable)(p + d, 1.0, variable(50e-6), OIL)[0] for d in (10.0, -10.0))
        assert slope == pytest.approx((above - below) / 20.0, rel=1e-6)


@given(
    free=st.floats(-2e7, 4e7), z=st.floats(7.0, 11.5).map(lambda e: 10.0**e), before=st.floats(-1e5, 2e7),
    displacement=st.floats(0.1, 1.0), time=st.sampled_from([0.0, 1e-5, 30e-3]),
)  # fmt: skip
def test_pump_and_port_have_one_pressure(free: float, z: float, before: float, displacement: float, time: float):
    """Whatever the port and the state: the flow is that of the pump at the pressure where it meets the port."""
    pump, memory = variable(50e-6, time=time), np.full(12, displacement)
    q = interpreted(variable_flow)(1.0, Port(free, z), before, memory, pump, OIL, 50e-6)
    p = max(OIL.vapour_pressure, free + z * q)
    assert q == pytest.approx((1.0 + p / 1.3e9) * (5e-4 * memory[0] - LEAK * p), rel=1e-6, abs=1e-9)
    assert 0.1 - 1e-12 <= memory[0] <= 1.0 + 1e-12


@given(st.floats(-3e7, 3e7), st.floats(7.0, 11.0).map(lambda e: 10.0**e), st.floats(0.0, 1e-10))
def test_a_fixed_pump_meets_its_port(free: float, z: float, leakage: float):
    """p = c + Z (1 + p/B)(Q - k p), solved to rounding where it is above the vapour pressure."""
    p = interpreted(delivery_pressure)(Port(free, z), 5e-4, -leakage, OIL)
    met = free + z * (1.0 + p / OIL.bulk_modulus) * (5e-4 - leakage * p)
    assert p == pytest.approx(max(OIL.vapour_pressure, met), rel=1e-9, abs=1.0)


@given(st.floats(-3e7, 3e7), st.floats(7.0, 11.0).map(lambda e: 10.0**e), st.floats(7.0, 12.0).map(lambda e: 10.0**e))
def test_a_pressure_source_meets_its_port(free: float, z: float, resistance: float):
    """Q = (p_s - p)/R with p = c + Z Q, or at the vapour pressure where that is more."""
    q = interpreted(sourced)(Port(free, z), 1.0, PressureSource(210 * BAR, resistance, 0.0), OIL)
    p = max(OIL.vapour_pressure, free + z * q)
    assert q * resistance == pytest.approx(210 * BAR - p, rel=1e-9, abs=1.0)
