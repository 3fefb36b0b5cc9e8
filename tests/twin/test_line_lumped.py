"""Lumped line: what it keeps, its first mode, its order, and the step up to which it is passive."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.exact_line import (
    HELD_FLOW,
    HELD_PRESSURE,
    STEEL,
    Pipe,
    at_rest,
    run,
)
from twin.integration import integrate
from twin.lines.bank import bank_of, memory_size, settle, steady_drop

PIPE = Pipe(2.5, 11e-3, 40e-6, STEEL, 878.0)


def test_no_oil_is_lost():
    """C/2 of each end times its pressure is what has flowed in; trapezoidal, so the last flow is zero here."""
    bank, memory = at_rest(PIPE.spec("lumped"), 50e-6)
    values = np.random.default_rng(0).normal(size=(5000, 2)) * 1e-5
    values[-1] = 0.0
    out = run(bank, memory, (HELD_FLOW, HELD_FLOW), values)
    assert 0.5 * bank.capacity[0] * out[-1, :2].sum() == pytest.approx(50e-6 * values.sum(), rel=1e-9)


@pytest.mark.parametrize("flow", [1e-5, 8e-4])
def test_steady_start_stays_steady(flow: float):
    """Laminar and turbulent. 1e-9: rounding, summed over 20000 steps."""
    bank = bank_of([PIPE.spec("lumped")], 50e-6, -1e5)
    memory = np.zeros(memory_size(bank))
    drop = steady_drop(bank, 0, flow)
    settle(bank, memory, np.array([5e6 + drop, 5e6]), np.array([flow]))
    out = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.tile([flow, 5e6], (20000, 1)))
    assert out[:, 0] == pytest.approx(5e6 + drop, rel=1e-9)
    assert out[:, 3] == pytest.approx(-flow, rel=1e-9)


def test_turbulent_drop_is_that_of_blasius():
    """0.3164 Re^-1/4 rho v^2/2 l/d at Re 10000, reached from rest."""
    q = 1e4 * math.pi / 4.0 * 11e-3 * 40e-6
    v = q / (math.pi / 4.0 * 11e-3**2)
    bank, memory = at_rest(PIPE.spec("lumped"), 50e-6)
    p = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.tile([q, 0.0], (60000, 1)))[-1, 0]
    assert p == pytest.approx(0.3164 * 1e4**-0.25 * 878.0 * v**2 / 2.0 * PIPE.length / 11e-3, rel=1e-6)


def test_first_mode_is_10_percent_below_the_quarter_wave():
    """One end shut, the other held: sqrt(2) a/l with half of the oil at the end, not (pi/2) a/l. Counted over 60
    periods without friction; 1e-3: the time of one crossing, and (omega h)^2/24."""
    bank, memory = at_rest(PIPE.spec("lumped", "none"), 50e-6)
    values = np.zeros((6000, 2))
    values[0, 0] = 1e-5
    p = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), values)[1:, 0]
    rising = np.flatnonzero((p[:-1] < 0.0) & (p[1:] >= 0.0))
    omega = 2.0 * math.pi * (len(rising) - 1) / ((rising[-1] - rising[0]) * 50e-6)
    assert omega == pytest.approx(math.sqrt(2.0) * STEEL / PIPE.length, rel=1e-3)


def test_order_is_two():
    """A smooth flow into a shut, laminar line, against scipy: halving the step quarters the error."""
    c, i = (bank := bank_of([PIPE.spec("lumped")], 50e-6, -1e5)).capacity[0], bank.inertance[0]

    def flow(t: float) -> float:
        return 1e-5 * math.sin(300.0 * t) ** 2

    def rates(t: float, y: np.ndarray) -> list[float]:
        return [2.0 / c * (flow(t) - y[2]), 2.0 / c * y[2], (y[0] - y[1] - bank.resistance[0] * y[2]) / i]

    end = integrate(rates, (0.0, 0.01), [0.0, 0.0, 0.0], "DOP853", most=200_000, rtol=1e-12, atol=1e-12).y[:, -1]

    def miss(step: float) -> float:
        line, memory = at_rest(PIPE.spec("lumped"), step)
        steps = round(0.01 / step)
        values = np.array([[flow(k * step), 0.0] for k in range(1, steps + 1)])
        return float(np.abs(run(line, memory, (HELD_FLOW, HELD_FLOW), values)[-1, :2] - end[:2]).max())

    assert math.log2(miss(50e-6) / miss(25e-6)) == pytest.approx(2.0, abs=0.1)


@given(st.floats(-2e-3, 2e-3), st.floats(-1e8, 1e8), st.sampled_from([20e-6, 100e-6, 1e-3]))
def test_friction_only_takes(flow: float, drop: float, step: float):
    """E (Q + dQ/2) >= 0 in any step, from laminar to turbulent, also where the flow turns. 1e-9: rounding."""
    bank = bank_of([PIPE.spec("lumped")], step, -1e12)
    memory = np.zeros(memory_size(bank))
    settle(bank, memory, np.array([drop, 0.0]), np.array([flow]))
    p = run(bank, memory, (HELD_PRESSURE, HELD_PRESSURE), np.array([[drop, 0.0]]))[0, :2]
    after = memory[2 * len(bank.model) + 2]
    lost = p[0] - p[1] - bank.inertance[0] * (after - flow) / step
    assert lost * (flow + after) >= -1e-9 * abs(drop) * (abs(flow) + abs(after))


@pytest.mark.parametrize("share", [0.98, 1.02])
def test_passive_up_to_a_step_of_its_travel_time(share: float):
    """h < sqrt(I C) = l/a, derived in lumped.py, on both sides: refused beyond, bounded in a shut line below."""
    spec, step = PIPE.spec("lumped", "none"), share * PIPE.travel_time
    if share > 1.0:
        with pytest.raises(ValueError, match=r"pipe_1, 2\.5 m: step .* limit 0\.0022 s .* smaller loop\.step"):
            bank_of([spec], step, -1e5)
        return
    bank, memory = at_rest(spec, step)
    values = np.zeros((100_000, 2))
    values[0, 0] = 1e-5
    out = run(bank, memory, (HELD_FLOW, HELD_FLOW), values)
    assert np.abs(out[-1000:, :2]).max() <= 1.01 * np.abs(out[:1000, :2]).max()


def test_beyond_the_limit_a_shut_line_diverges():
    """What the refusal protects from: the same coefficients of a step 2 % too coarse."""
    bank, memory = at_rest(PIPE.spec("lumped", "none"), 0.98 * PIPE.travel_time)
    numbers = bank.lumped_numbers.copy()
    numbers[:, :2] *= 1.02 / 0.98
    values = np.zeros((100, 2))
    values[0, 0] = 1e-5
    out = run(bank._replace(lumped_numbers=_frozen(numbers)), memory, (HELD_FLOW, HELD_FLOW), values)
    assert np.abs(out[-10:, :2]).max() > 1e3 * np.abs(out[:10, :2]).max()


def _frozen(array: np.ndarray) -> np.ndarray:
    array.flags.writeable = False
    return array
