"""Servo valve: rated flow, flow and pressure gain at null, leakage and underlap in closed form, oil, energy, force."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.plant import BAR
from twin.kernel import kernel
from twin.lands import Lands, Ports
from twin.oil import Oil
from twin.orifice import Orifice
from twin.port import Port, pressure
from twin.servo_opening import ByTable, InProportion, hinges, opening_slope, share_open
from twin.servo_spool import SpoolMotion
from twin.servo_valve import (
    FORCE,
    VALVE_MEMORY,
    Edge,
    ServoValve,
    edge_leak,
    rated_area,
    servo_areas,
    servo_flows,
    tightening,
)

Array = NDArray[np.float64]
VAPOUR = -1.0 * BAR
OIL = Oil(878.0, 40e-6, 1.17e9, VAPOUR)
MU = OIL.density * OIL.viscosity
TURBULENT = Orifice(0.61, 0.0)
RATED, DROP = 38e-3 / 60.0, 70 * BAR
STRAIGHT = InProportion()
STIFF = 1e4  # [Pa s/m^3], of a port that keeps its pressure
STILL = SpoolMotion(0.0, 0.0, 0.0, 0.0, 1e9, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def valve(
    laps: tuple[float, ...] = (0.0,) * 4,
    ratios: tuple[float, ...] = (1.0,) * 4,
    leak: float = 0.0,
    opening: InProportion | ByTable = STRAIGHT,
    orifice: Orifice = TURBULENT,
    **numbers: Any,
) -> ServoValve:
    area = rated_area(RATED, DROP, leak, orifice, OIL)
    lands = (Edge(lap, ratio * area, ratio * leak) for lap, ratio in zip(laps, ratios, strict=True))
    p_a, b_t, p_b, a_t = lands
    plain = ServoValve(STILL, opening, p_a, b_t, p_b, a_t, tightening(0.5e-3, 3e-6), 0.0, 0.0, orifice)
    return plain._replace(**numbers)


@kernel
def _flows(valve, spools, free, impedance, memory, out) -> None:
    oil = Oil(878.0, 40e-6, 1.17e9, -1e5)
    for k in range(len(spools)):
        c, z = free[k], impedance[k]
        ports = Ports(Port(c[0], z[0]), Port(c[1], z[1]), Port(c[2], z[2]), Port(c[3], z[3]))
        q = servo_flows(valve, spools[k], ports, memory, oil)
        row = out[k]
        row[0], row[1], row[2], row[3], row[4] = q.p_a, q.b_t, q.p_b, q.a_t, memory[FORCE]


def flows(valve: ServoValve, spool: float, p: tuple[float, ...], z: tuple[float, ...] = (STIFF,) * 4) -> Lands:
    """Flows [m^3/s] between ports of free pressures [Pa]."""
    out = np.zeros((1, 5))
    _flows(valve, np.array([spool]), np.array([p]), np.array([z]), np.zeros(VALVE_MEMORY), out)
    p_a, b_t, p_b, a_t = out[0, :4].tolist()
    return Lands(p_a, b_t, p_b, a_t, 0.0)


@pytest.mark.parametrize("orifice", [TURBULENT, Orifice(0.61, 30.0)])
@pytest.mark.parametrize("leak", [0.0, 1e-12])
def test_fully_open_it_passes_the_rated_flow_at_the_rated_drop(orifice: Orifice, leak: float):
    """Half of the drop over each of two lands, the leak of the open one counted."""
    q = flows(valve(leak=leak, orifice=orifice), 1.0, (DROP, 0.5 * DROP, 0.5 * DROP, 0.0))
    assert q.p_a == pytest.approx(RATED, rel=1e-5)
    assert q.b_t == pytest.approx(RATED, rel=1e-5)


def test_asymmetric_lands_pass_their_ratio():
    """2:1: at the same drop half of the flow through the lands of A."""
    made = valve(ratios=(0.5, 1.0, 1.0, 0.5))
    up = flows(made, 0.6, (DROP, 0.5 * DROP, 0.5 * DROP, 0.0))
    down = flows(made, -0.6, (DROP, 0.5 * DROP, 0.5 * DROP, 0.0))
    assert up.p_a / up.b_t == pytest.approx(0.5, rel=1e-6)
    assert down.a_t / down.p_b == pytest.approx(0.5, rel=1e-6)


def test_flow_gain_of_a_critical_centre():
    """Merritt 5-30 .. 5-33: no-load flow C_d w x sqrt(p_s/rho), straight through null: Q_R sqrt(p_s/p_R) per travel."""
    supply = 140 * BAR
    for x in (-0.5, -1e-3, 1e-3, 0.5):
        q = flows(valve(), x, (supply, 0.5 * supply, 0.5 * supply, 0.0))
        assert q.p_a - q.a_t == pytest.approx(RATED * math.sqrt(supply / DROP) * x, rel=1e-4)


def test_pressure_gain_at_null_of_a_critical_centre():
    """Ports blocked: with leaks g d only, both halves are dividers. A: o(x) sqrt(d) + g d above against g' d below.

    Slope of p_A - p_B at null: the turbulent flow C x sqrt(p_s/2) of an opening meets 2 g, 5-33 with k_c = g_0."""
    leak, supply, x = 1e-12, 140 * BAR, 1e-7
    made = valve(leak=leak, tightening=0.0)
    q = blocked(made, x, supply)
    a, b = 0.5 * supply + 1e17 * (q.p_a - q.a_t), 0.5 * supply + 1e17 * (q.p_b - q.b_t)
    gain = (RATED - 0.5 * leak * DROP) * math.sqrt(supply / DROP)  # turbulent flow per travel
    assert (a - b) / x == pytest.approx(2.0 * gain / (2.0 * leak + 1.0 / 1e17), rel=1e-4)


def blocked(made: ServoValve, x: float, supply: float) -> Lands:
    return flows(made, x, (supply, 0.5 * supply, 0.5 * supply, 0.0), (STIFF, 1e17, 1e17, STIFF))


def test_leakage_curve_has_its_top_at_null():
    """Ports blocked: q = g_0 p_s at null (5-66); beyond it the two lands in series that overlap by x alone count,
    g = g_0/(1 + k x), the others being open wide: it falls as the hyperbola of the overlap."""
    leak, supply = 1e-12, 140 * BAR
    made, k = valve(leak=leak), tightening(0.5e-3, 3e-6)
    at_null = blocked(made, 0.0, supply)
    assert at_null.p_a + at_null.p_b == pytest.approx(leak * supply, rel=1e-5)
    for x in (0.05, -0.2, 0.7):
        q = blocked(made, x, supply)
        assert q.p_a + q.p_b == pytest.approx(2.0 * leak / (1.0 + k * abs(x)) * supply, rel=2e-3)
        assert q.p_a == pytest.approx(q.a_t, rel=1e-3)


def test_leak_of_a_land_is_that_of_the_slots():
    """pi w c^2/(32 mu) at the edge in series with 12 mu L/(w c^3) under the overlap, by Merritt's formulas."""
    w, c, travel = 20e-3, 4e-6, 0.6e-3
    edge = Edge(0.0, 1e-5, math.pi * w * c**2 / (32.0 * MU))
    made = valve(tightening=tightening(travel, c))
    for overlap in (0.0, 0.02, 0.5):
        slots = 32.0 * MU / (math.pi * w * c**2) + 12.0 * MU * overlap * travel / (w * c**3)
        assert edge_leak(-overlap, edge, made) == pytest.approx(1.0 / slots, rel=1e-12)


@pytest.mark.parametrize("micrometres", [1.0, 20.0, 200.0])
def test_underlapped_null_flow(micrometres: float):
    """All four lands open by the underlap u of a travel of 1 mm, ports blocked: A and B at half of the supply, and
    2 C_d w u sqrt(p_s/rho) runs to the tank, 5-60."""
    share, supply = micrometres * 1e-3, 210 * BAR
    q = blocked(valve(laps=(-share,) * 4), 0.0, supply)
    expected = RATED * math.sqrt(supply / DROP) * share / (1.0 + share)
    assert q == pytest.approx(Lands(expected, expected, expected, expected, 0.0), rel=1e-4)


def test_open_centre_has_twice_the_flow_gain():
    """Inside the underlap both lands of a port move, 5-62: linear valve, K_q = 2 C_d w sqrt(p_s/rho)."""
    share, supply, x = 0.05, 210 * BAR, 1e-3
    q = flows(valve(laps=(-share,) * 4), x, (supply, 0.5 * supply, 0.5 * supply, 0.0))
    one = RATED * math.sqrt(supply / DROP) / (1.0 + share)
    assert q.p_a - q.a_t == pytest.approx(2.0 * one * x, rel=1e-4)


def test_null_bias_moves_the_null():
    supply = 140 * BAR
    made = valve(laps=(-0.01,) * 4, null_bias=0.03)
    q = flows(made, 0.03, (supply, 0.5 * supply, 0.5 * supply, 0.0))
    assert q.p_a - q.a_t == pytest.approx(0.0, abs=1e-12)
    assert servo_areas(0.03 + 0.2, made).p_a == pytest.approx(servo_areas(0.03 - 0.2, made).p_b)


POINTS = ((0.0, 0.0), (0.4, 0.1), (0.5, 0.35), (1.0, 1.0))


def test_a_table_gives_the_area_between_its_points():
    table = hinges(POINTS)
    x, y = np.array(POINTS).T
    for beyond in np.linspace(0.0, 1.0, 41):
        assert share_open(table, float(beyond)) == pytest.approx(np.interp(beyond, x, y), abs=1e-15)
    for beyond, slope in ((0.0, 0.25), (0.39, 0.25), (0.4, 2.5), (0.7, 1.3)):
        assert opening_slope(table, beyond) == pytest.approx(slope)
    made = valve(laps=(0.1, 0.1, -0.1, -0.1), opening=table)
    assert servo_areas(0.1 + 0.9 * 0.4, made).p_a == pytest.approx(0.1 * made.p_a.area)
    assert servo_areas(0.1 + 0.9 * 0.4, made).p_b == 0.0
    assert servo_areas(1.1 * 0.4 - 0.1, made).a_t == 0.0
    assert servo_areas(0.1 - 1.1 * 0.4, made).p_b == pytest.approx(0.1 * made.p_b.area)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (((0.0, 0.0),), "has 1 points; take 2 to 9"),
        (((0.0, 0.1), (1.0, 1.0)), r"begins at \(0\.0, 0\.1\)"),
        (((0.0, 0.0), (0.5, 0.4), (0.5, 0.6), (1.0, 1.0)), "ways must grow"),
        (((0.0, 0.0), (0.5, 0.4), (0.6, 0.3), (1.0, 1.0)), "areas not fall"),
    ],
)
def test_a_table_that_is_none_is_refused(points: tuple[tuple[float, float], ...], words: str):
    with pytest.raises(ValueError, match=words):
        hinges(points)


def test_a_leak_beyond_the_rated_flow_is_refused():
    with pytest.raises(ValueError, match=r"servo_valve.leakage alone passes .* take less leakage"):
        rated_area(RATED, DROP, 1e-9, TURBULENT, OIL)


FREE = st.floats(-50 * BAR, 250 * BAR)
IMPEDANCE = st.floats(3e8, 5e10)
LAP = st.sampled_from([-0.2, -1e-3, 0.0, 1e-3, 0.1])


@given(
    st.tuples(FREE, FREE, FREE, FREE),
    st.tuples(IMPEDANCE, IMPEDANCE, IMPEDANCE, IMPEDANCE),
    st.tuples(LAP, LAP, LAP, LAP),
    st.sampled_from([0.0, 1e-13, 1e-12]),
    st.floats(-1.0, 1.0),
)
def test_whatever_is_open_it_takes_energy_alone(
    free: tuple[float, ...], z: tuple[float, ...], laps: tuple[float, ...], leak: float, spool: float
):
    """Of the ports -sum p q, q into the lines; what leaves P and A, B, T is the same oil by its making."""
    q = flows(valve(laps=laps, leak=leak, ratios=(1.0, 0.7, 0.5, 1.2)), spool, free, z)
    into = (-(q.p_a + q.p_b), q.p_a - q.a_t, q.p_b - q.b_t, q.b_t + q.a_t)
    p = [pressure(Port(c, impedance), flow, VAPOUR) for c, impedance, flow in zip(free, z, into, strict=True)]
    assert -sum(a * b for a, b in zip(p, into, strict=True)) >= -1e-3 * max(map(abs, q))


def test_flow_force_shuts_the_valve():
    """At the rated drop and fully open it is kappa: half of the drop over each of two lands, and against the way."""
    made = valve()
    made = made._replace(flow_force=0.08 / (made.p_a.area * DROP))
    for x, supply, share in ((1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (0.5, 2.0, 1.0)):
        out, memory = np.zeros((1, 5)), np.zeros(VALVE_MEMORY)
        p = np.array([[supply * DROP, 0.5 * supply * DROP, 0.5 * supply * DROP, 0.0]])
        _flows(made, np.array([x]), p, np.full((1, 4), STIFF), memory, out)
        assert out[0, 4] == pytest.approx(-math.copysign(0.08 * share, x), rel=1e-5)


def test_the_answer_does_not_depend_on_the_instant_before():
    """A valve swept through null, warm from step to step, and each place by itself: the same flows."""
    made, count = valve(laps=(-1e-3,) * 4, leak=2e-13), 400
    spools = 0.01 * np.sin(np.linspace(0.0, 20.0, count))
    free = np.tile([200 * BAR, 90 * BAR, 110 * BAR, 3 * BAR], (count, 1))
    z = np.tile([3e9, 8e9, 8e9, 3e9], (count, 1))
    warm = np.zeros((count, 5))
    _flows(made, spools, free, z, np.zeros(VALVE_MEMORY), warm)
    for k in range(0, count, 40):
        cold = np.zeros((1, 5))
        _flows(made, spools[k : k + 1], free[k : k + 1], z[k : k + 1], np.zeros(VALVE_MEMORY), cold)
        assert warm[k, :4] == pytest.approx(cold[0, :4], rel=1e-8, abs=1e-14)
