"""Direct-operated relief valve: static characteristic, lag, hysteresis, stop, energy, and scipy's Radau."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.integration import integrate
from twin.kernel import interpreted, kernel
from twin.port import Port
from twin.relief.direct import (
    OPENING,
    DirectRelief,
    begin_direct,
    direct_flow,
    direct_relief,
    direct_slope,
    steady_direct,
)

BAR, H = 1e5, 50e-6
CAPACITY = 0.4e-3 / 1.3e9
NUMBERS: dict[str, Any] = {
    "cracking_pressure": 119 * BAR, "rated_flow": 4.8e-4, "override": 1 * BAR, "flow_force_share": 12.0 / 19.0,
    "time_constant": 5e-3, "hysteresis": 0.0,
}  # fmt: skip
steady, slope = interpreted(steady_direct), interpreted(direct_slope)


def valve(step: float = H, **numbers: float) -> DirectRelief:
    return direct_relief(NUMBERS | numbers, step)


@kernel
def fed(relief: DirectRelief, capacity: float, inflow, step: float, p: float, memory, out) -> None:
    """A volume into which a flow runs at each instant, by the trapezoidal rule: flow, pressure and opening."""
    begin_direct(p, memory, relief)
    q = steady_direct(p, relief)
    for i in range(len(out)):
        half = 0.5 * step / capacity
        port = Port(p + half * (inflow[i] - q + inflow[i + 1]), half)
        q = direct_flow(port, memory, relief)
        p = port.free - port.impedance * q
        out[i, 0], out[i, 1], out[i, 2] = q, p, memory[OPENING]


def run(inflow: np.ndarray, start: float, relief: DirectRelief, step: float = H) -> np.ndarray:
    out = np.zeros((len(inflow) - 1, 3))
    fed(relief, CAPACITY, inflow, step, start, np.zeros(12), out)
    return out.T


def swinging(t: np.ndarray) -> np.ndarray:
    """A flow [m^3/s] that starts at none and goes up and down between none and twice the rated."""
    return 4.8e-4 * (1.0 - np.cos(40.0 * t))


def test_static_characteristic_passes_the_rated_point_and_cracks_where_stated():
    v = valve()
    assert steady(119 * BAR, v) == 0.0
    assert steady(118 * BAR, v) == 0.0
    assert steady(120 * BAR, v) == pytest.approx(4.8e-4, rel=1e-12)
    half = 0.5 * math.sqrt(119.5 / 120.0) / ((7.0 + 12.0 * 119.5 / 120.0) / 19.0)  # less flow force at less pressure
    assert steady(119.5 * BAR, v) == pytest.approx(half * 4.8e-4, rel=1e-12)
    assert slope(119.7 * BAR, v) == pytest.approx((steady(11970010.0, v) - steady(11969990.0, v)) / 20.0, rel=1e-6)


def test_plain_numbers_contain_the_characteristic_of_two_coefficients():
    """x_s = (p - p_0)/(sqrt(p_r)/k + dp/(k sqrt(p_r))): with the rated flow and share that it has at 120 bar, the same
    opening at every pressure, to rounding. k = 1e-8, p_r = 70 bar, tank at 1 bar absolute."""
    k, root = 1e-8, math.sqrt(7e6)

    def printed(p: float) -> float:
        return (p - 119 * BAR) / (root / k + p / (k * root)) * math.sqrt(p)

    same = valve(rated_flow=printed(120 * BAR), flow_force_share=12e6 / (7e6 + 12e6))
    for bar in (119.01, 119.5, 120.0, 121.0, 130.0):
        assert steady(bar * BAR, same) == pytest.approx(printed(bar * BAR), rel=1e-12)


def test_a_volume_that_is_fed_agrees_with_radau_and_the_step_is_of_second_order():
    """The valve open throughout; then error by four for each halving of the step."""

    def inflow(t: Any) -> Any:
        return 4.8e-4 * (1.0 + 0.5 * np.sin(60.0 * t))

    rated = 4.8e-4 / math.sqrt(120 * BAR)
    spring, force = (7.0 / 19.0) * BAR / rated, (12.0 / 19.0) * BAR / (rated * 120 * BAR)

    def rates(t: float, y: np.ndarray) -> list[float]:
        p, x = 120 * BAR + y[0] * BAR, y[1] * rated
        x_s = (p - 119 * BAR) / (spring + force * p)
        return [(float(inflow(t)) - x * math.sqrt(p)) / CAPACITY / BAR, (x_s - x) / 5e-3 / rated]

    at = np.arange(1, 51) * 1e-3
    found = integrate(rates, (0.0, 0.05), [0.0, 1.0], "Radau", t_eval=at, rtol=1e-10, atol=1e-12, most=60000)
    errors = []
    for step in (0.1e-3, H, 25e-6):
        times = step * np.arange(round(0.05 / step) + 1)
        p = run(inflow(times), 120 * BAR, valve(step), step)[1]
        assert p.min() > 119 * BAR
        every = round(1e-3 / step)
        errors.append(float(np.abs(p[every - 1 :: every] / BAR - 120.0 - found.y[0]).max()))
    assert errors[1] < 0.02  # [bar]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.2)


def test_at_a_held_pressure_it_opens_and_shuts_by_the_exponential():
    """From 1 to 1.5 bar of override, then down to 3 bar below cracking: it meets its seat at T log(1 + x/|x_s|)."""
    v, memory = valve(), np.zeros(12)
    interpreted(begin_direct)(120 * BAR, memory, v)
    opening = memory[OPENING]
    target = steady(120.5 * BAR, v) / math.sqrt(120.5 * BAR)
    step_to(120.5 * BAR, memory, v)  # the step within which the pressure goes there
    begun = memory[OPENING]
    for k in range(1, 101):
        step_to(120.5 * BAR, memory, v)
        assert memory[OPENING] == pytest.approx(target + (begun - target) * math.exp(-k * H / 5e-3), rel=1e-9)
    assert opening < begun < target
    step_to(116 * BAR, memory, v)
    x, below = memory[OPENING], interpreted_wanted(116 * BAR, v)
    steps = 0
    while memory[OPENING] > 0.0:
        step_to(116 * BAR, memory, v)
        steps += 1
    assert steps == math.ceil(5e-3 / H * math.log1p(x / -below))
    assert step_to(116 * BAR, memory, v) == 0.0


def interpreted_wanted(p: float, v: DirectRelief) -> float:
    return (p - v.cracking_pressure) / (v.spring + v.flow_force * p)


def step_to(p: float, memory: np.ndarray, v: DirectRelief) -> float:
    return interpreted(direct_flow)(Port(p, 0.0), memory, v)


def test_hysteresis_shuts_it_that_much_lower_than_it_cracks():
    """A slow ramp up and down, 4 s each: the branches of the static curve lie 2 bar apart."""
    v = valve(hysteresis=2 * BAR)
    up = np.linspace(117 * BAR, 121 * BAR, 4000)
    memory = np.zeros(12)
    interpreted(begin_direct)(117 * BAR, memory, v)
    rising = np.array([step_slow(p, memory, v) for p in up])
    falling = np.array([step_slow(p, memory, v) for p in up[::-1]])[::-1]
    cracks, shuts = up[rising > 0.0][0], up[falling > 0.0][0]
    assert cracks == pytest.approx(119 * BAR, abs=2e3)
    assert shuts == pytest.approx(117 * BAR, abs=2e3)
    assert rising[-1] == pytest.approx(steady(121 * BAR, v), rel=1e-3)


def step_slow(p: float, memory: np.ndarray, v: DirectRelief) -> float:
    """A second at a pressure, which is many time constants."""
    return interpreted(direct_flow)(
        Port(p, 0.0), memory, v._replace(lag=v.lag._replace(kept=0.0, before=0.0, after=1.0))
    )


@given(
    free=st.floats(-1e5, 4e7), z=st.floats(7.0, 12.0).map(lambda e: 10.0**e), opening=st.floats(0.0, 1e-6),
    play=st.floats(0.0, 2e7), hysteresis=st.floats(0.0, 5e5), time=st.sampled_from([0.0, 1e-5, 5e-3]),
)  # fmt: skip
def test_any_port_is_met_by_the_law_and_energy_only_taken(free, z, opening, play, hysteresis, time):
    """Q = x sqrt(p) at the pressure that the port then has, p Q >= 0, x >= 0; shut is exactly shut."""
    v, memory = valve(hysteresis=hysteresis, time_constant=time), np.zeros(12)
    memory[:3] = opening, play, interpreted_wanted(play, v)
    q = interpreted(direct_flow)(Port(free, z), memory, v)
    p = free - z * q
    assert q >= 0.0
    assert memory[OPENING] >= 0.0
    assert p * q >= -1e-9
    assert q == pytest.approx(memory[OPENING] * math.sqrt(max(0.0, p)), rel=1e-6, abs=1e-9 * max(1.0, free) / z)
    assert memory[OPENING] > 0.0 or q == 0.0


def test_between_none_and_twice_the_rated_flow_it_opens_shuts_and_converges():
    """Through the stop: half the step leaves about half of the error or less; no flow passes a shut valve."""
    ends = []
    for step in (0.2e-3, 0.1e-3, H, 25e-6):
        times = step * np.arange(round(0.4 / step) + 1)
        q, p, x = run(swinging(times), 100 * BAR, valve(step), step)
        assert (q[x == 0.0] == 0.0).all()
        assert 0.05 < np.mean(x == 0.0) < 0.95
        ends.append(p[round(0.02 / step) - 1 :: round(0.02 / step)])
    gaps = [float(np.abs(a - b).max()) for a, b in pairwise(ends)]
    assert gaps[1] < 0.7 * gaps[0]
    assert gaps[2] < 0.7 * gaps[1]
