"""Bladder accumulator: the polytrope in closed form, energy, shut without oil, Radau, and what it is to a place."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.accumulator import (
    ATMOSPHERE,
    FLOW,
    OIL,
    Accumulator,
    begin_accumulator,
    fill_accumulator,
    gas_energy,
    gas_pressure,
    oil_at_rest,
    with_accumulator,
)
from twin.integration import integrate
from twin.kernel import interpreted, kernel
from twin.oil import Oil
from twin.port import Port

BAR, H = 1e5, 50e-6
FLUID = Oil(870.0, 40e-6, 1.3e9, -1e5)
STIFF = 1e19  # [Pa s/m^3]: a place that brings its flow whatever the pressure
ONE_LITRE = Accumulator(1e-3, 90 * BAR, 1.4, 3e12, 1e8)
gas = interpreted(gas_pressure)


@kernel
def fill_along(accumulator: Accumulator, free, z: float, brought, memory, oil: Oil, step: float, out) -> None:
    """A port whose c changes, with something else that brings a flow; the flow and the pressure of each step."""
    for i in range(len(out)):
        rest = Port(free[i], z)
        met = with_accumulator(accumulator, rest, memory, oil, step)
        q = fill_accumulator(accumulator, rest, brought[i], memory, oil, step)
        out[i, 0], out[i, 1] = q, max(oil.vapour_pressure, rest.free + z * (brought[i] - q))
        out[i, 2], out[i, 3] = memory[OIL], met.free + met.impedance * brought[i]


def along(free, z, brought, pressure: float, accumulator: Accumulator = ONE_LITRE, step: float = H):
    """Flow, pressure and oil of each step, and the pressure by the port that the others meet."""
    memory, out = np.zeros(12), np.zeros((len(free), 4))
    begin_accumulator(accumulator, pressure, float(brought[0]), memory)
    fill_along(accumulator, np.array(free), z, np.array(brought), memory, FLUID, step, out)
    return out.T


@pytest.mark.parametrize("exponent", [1.0, 1.25, 1.4])
def test_a_constant_flow_compresses_along_the_polytrope(exponent: float):
    """Half a litre into a litre at 0.1 l/s: (p + p_a) V^n stays, V_0/V = 2 makes 2^n; exact whatever the step."""
    accumulator = ONE_LITRE._replace(exponent=exponent)
    for step in (H, 5e-3):
        n = round(5.0 / step)
        free, brought = np.full(n, -STIFF * 1e-4), np.zeros(n)
        q, _, oil, _ = along(-free, STIFF, brought, 90 * BAR, accumulator, step)
        assert q == pytest.approx(1e-4, rel=1e-6)
        assert oil[-1] == pytest.approx(5e-4, rel=1e-6)
        p = gas(float(oil[-1]), accumulator)
        assert (p + ATMOSPHERE) * (1e-3 - oil[-1]) ** exponent == pytest.approx(91 * BAR * 1e-3**exponent, rel=1e-12)
        assert p + ATMOSPHERE == pytest.approx(91 * BAR * 2.0**exponent, rel=2e-6)


@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_energy_of_the_gas_is_the_work_done_on_it(exponent: float):
    """The closed form against a quadrature of p_g dS; at rest the gas carries the pressure."""
    accumulator = ONE_LITRE._replace(exponent=exponent)
    oil = np.linspace(0.0, 6e-4, 6001)
    p = np.array([gas(s, accumulator) for s in oil])
    work = float(np.sum(0.5 * (p[1:] + p[:-1]) * np.diff(oil)))
    assert gas_energy(6e-4, accumulator) == pytest.approx(work, rel=1e-6)
    assert gas(oil_at_rest(200 * BAR, accumulator), accumulator) == pytest.approx(200 * BAR, rel=1e-12)


def test_it_is_shut_below_its_precharge_and_opens_above_it():
    """80 bar at the place: exactly nothing flows; 120 bar: it fills; 20 bar: it gives back to the last drop."""
    free = np.repeat([80 * BAR, 120 * BAR, 20 * BAR], 20000)
    q, p, oil, _ = along(free, 5e8, np.zeros(60000), 80 * BAR)
    assert (q[:20000] == 0.0).all()
    assert (p[:20000] == 80 * BAR).all()
    assert oil[39999] == pytest.approx(oil_at_rest(120 * BAR, ONE_LITRE), rel=1e-3)
    assert oil.min() == 0.0
    assert oil[-1] == 0.0
    assert (q[-100:] == 0.0).all()
    assert float(q.sum()) * H == pytest.approx(0.0, abs=1e-15)


@given(
    st.lists(st.floats(-50.0, 400.0), min_size=2, max_size=12), st.floats(8.0, 11.0), st.floats(0.0, 14.0),
    st.floats(-6.0, -2.5), st.floats(1.0, 1.6), st.floats(-5e-4, 5e-4),
)  # fmt: skip
def test_oil_is_counted_and_energy_only_taken(bars, z, a, volume, exponent, brought):
    """Any jumps of c, any size: oil is the sum of the flows, never below 0; the gas holds no more than it was given,
    but for the curvature of p_g within a step."""
    accumulator = Accumulator(10.0**volume, 60 * BAR, exponent, 10.0**a, 0.0)
    free = np.repeat(np.array(bars) * BAR, 40)
    memory, start = np.zeros(12), 70 * BAR
    begin_accumulator(accumulator, start, 0.0, memory)
    first = float(memory[OIL])
    q, p, oil, _ = along(free, 10.0**z, np.full(len(free), brought), start, accumulator)
    assert np.isfinite(q).all()
    assert oil.min() >= 0.0
    assert np.abs(first + H * np.cumsum(q) - oil).max() <= 1e-13 * (H * np.abs(q).sum() + first)
    assert (p >= FLUID.vapour_pressure).all()
    before = np.concatenate([[first], oil[:-1]])
    held = np.array([gas_energy(float(s), accumulator) for s in np.concatenate([[first], oil])])
    largest = np.maximum(before, oil)
    moved, room = H * np.abs(q), accumulator.volume - largest
    absolute = np.array([gas(float(s), accumulator) for s in largest]) + ATMOSPHERE
    curved = exponent * (exponent + 1.0) / 6.0 * absolute * moved**3 / room**2
    assert (np.diff(held) <= H * q * p + curved + 1e-9 * np.abs(held[1:]) + 1e-12).all()


def test_a_place_with_gas_inertia_and_orifice_agrees_with_radau():
    """A column of oil (2 m of 11 mm) between a swinging pressure and the accumulator, and order 2 of the step."""
    inertance, swing = 878.0 * 2.0 / (math.pi / 4.0 * 0.011**2), 40.0

    def rates(t: float, y: np.ndarray) -> list[float]:
        q, s = y[0] * 1e-4, y[1] * 1e-4
        p_g = 91 * BAR * (1e-3 / (1e-3 - s)) ** 1.4 - ATMOSPHERE
        source = (150.0 + 20.0 * math.sin(swing * t)) * BAR
        return [(source - p_g - 3e12 * abs(q) * q - 1e8 * q) / inertance / 1e-4, q / 1e-4]

    first = [0.0, oil_at_rest(150 * BAR, ONE_LITRE) / 1e-4]
    found = integrate(rates, (0.0, 0.5), first, "Radau", rtol=1e-10, atol=1e-12, most=100000)

    def end(step: float) -> float:
        """The column is a port, q_1 = q_0 + h (p_s - (p_0 + p_1)/2)/L, by the trapezoidal rule."""
        memory, n = np.zeros(12), round(0.5 / step)
        begin_accumulator(ONE_LITRE, 150 * BAR, 0.0, memory)
        column(ONE_LITRE, inertance, swing, memory, FLUID, step, n)
        return float(memory[OIL] - 0.5 * step * memory[FLOW])  # the oil at the instant

    errors = [end(step) - float(found.y[1, -1]) * 1e-4 for step in (1e-3, 0.5e-3, H)]
    assert abs(errors[-1]) < 1e-5 * 1e-3
    assert math.log2(abs(errors[0] / errors[1])) == pytest.approx(2.0, abs=0.3)


@kernel
def column(accumulator: Accumulator, inertance: float, swing: float, memory, oil: Oil, step: float, n: int) -> None:
    """A column of oil from 150 bar and a swing of 20 bar; its flow starts at 0."""
    flow, drop = 0.0, 0.0
    for i in range(n):
        source = (150.0 + 20.0 * math.sin(swing * step * (i + 1.0))) * 1e5
        z = 2.0 * inertance / step
        rest = Port(source + z * (flow + 0.5 * step / inertance * drop), z)
        flow = fill_accumulator(accumulator, rest, 0.0, memory, oil, step)
        drop = source - (rest.free - z * flow)


@given(st.floats(-2e7, 4e7), st.floats(8.0, 11.0), st.floats(-1e-3, 1e-3), st.floats(0.0, 3e-4))
def test_the_port_that_others_meet_is_the_place_where_they_bring_what_they_brought(free, z, brought, stored):
    """It has the accumulator's slope, so at the flow of before it gives the pressure of the full law."""
    memory = np.zeros(12)
    memory[:3] = stored, 0.0, brought
    rest = Port(free, 10.0**z)
    met = with_accumulator(ONE_LITRE, rest, memory, FLUID, H)
    q = fill_accumulator(ONE_LITRE, rest, brought, memory, FLUID, H)
    p = rest.free + rest.impedance * (brought - q)
    if p >= FLUID.vapour_pressure:
        assert met.free + met.impedance * brought == pytest.approx(p, rel=1e-6, abs=1.0)
    assert met.impedance <= rest.impedance
