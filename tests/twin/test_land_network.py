"""Five lands between four ports: the answer of an independent solver, balance, no energy made, few iterations."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import root

from tests.support.plant import BAR
from twin.kernel import kernel
from twin.land_law import Laws, land_drop, land_flow, land_law
from twin.land_network import MOST_ITERATIONS, TIGHT, network_flows, port_pressures
from twin.lands import Lands, Ports, land_flows
from twin.oil import Oil
from twin.orifice import Orifice, flow
from twin.port import Port

Array = NDArray[np.float64]
VAPOUR = -1.0 * BAR
OIL = Oil(878.0, 40e-6, 1.17e9, VAPOUR)
SOURCE, SINK = np.array([0, 2, 0, 1, 0]), np.array([1, 3, 2, 3, 3])  # of P-A, B-T, P-B, A-T, P-T among P, A, B, T


@kernel
def solve(free, impedance, areas, leaks, transition: float, guess, flows, iterations) -> None:
    """Fill `flows` and `iterations`, a row per network."""
    oil, edge = Oil(878.0, 40e-6, 1.17e9, -1e5), Orifice(0.61, transition)
    for k in range(len(free)):
        c, z, a, g, q = free[k], impedance[k], areas[k], leaks[k], guess[k]
        ports = Ports(Port(c[0], z[0]), Port(c[1], z[1]), Port(c[2], z[2]), Port(c[3], z[3]))
        laws = Laws(
            land_law(a[0], g[0], edge, oil),
            land_law(a[1], g[1], edge, oil),
            land_law(a[2], g[2], edge, oil),
            land_law(a[3], g[3], edge, oil),
            land_law(a[4], g[4], edge, oil),
        )
        q, iterations[k] = network_flows(ports, laws, Lands(q[0], q[1], q[2], q[3], q[4]), oil)
        row = flows[k]
        row[0], row[1], row[2], row[3], row[4] = q.p_a, q.b_t, q.p_b, q.a_t, q.p_t


def networks(count: int, seed: int) -> tuple[Array, Array, Array, Array]:
    """Free pressures, impedances, areas and leaks: some ports at one pressure, some lands shut, some ports vapour."""
    rng = np.random.default_rng(seed)
    free, impedance = rng.uniform(-50 * BAR, 250 * BAR, (count, 4)), 10 ** rng.uniform(8.5, 11.0, (count, 4))
    for one, other in ((0, 1), (1, 2), (0, 3), (2, 3)):
        same = rng.random(count) < 0.05
        free[same, one] = free[same, other]
    areas, leaks = 10 ** rng.uniform(-10.0, -4.0, (count, 5)), 10 ** rng.uniform(-15.0, -11.0, (count, 5))
    areas[rng.random((count, 5)) < 0.3] = 0.0
    areas[rng.random(count) < 0.5, 4] = 0.0
    leaks[rng.random((count, 5)) < 0.3] = 0.0
    leaks[rng.random(count) < 0.3] = 0.0
    return free, impedance, areas, leaks


def pressures_at(flows: Array, free: Array, impedance: Array) -> Array:
    """Of P, A, B, T, a row per network."""
    into = np.zeros_like(free)
    for land in range(5):
        into[:, SOURCE[land]] -= flows[:, land]
        into[:, SINK[land]] += flows[:, land]
    return np.maximum(VAPOUR, free + impedance * into)


def taken(drops: Array, areas: Array, leaks: Array, transition: float) -> Array:
    """Flow of each land at its drop, stated once more: the quadratic solved for the flow."""
    wide = np.maximum(areas, 1e-30)
    a = OIL.density / (2.0 * 0.61**2 * wide**2)
    b = a * wide * OIL.viscosity * transition / np.sqrt(4.0 * wide / math.pi)
    through = 2.0 * drops / (b + np.sqrt(b * b + 4.0 * a * np.abs(drops)) + 1e-300)
    return np.where(areas > 0.0, through, 0.0) + leaks * drops


def solved(transition: float, warm: bool, count: int = 20_000) -> tuple[tuple[Array, ...], Array, Array]:
    given = networks(count, seed=round(10 * transition) + warm)
    flows, guess, iterations = np.zeros((count, 5)), np.zeros((count, 5)), np.zeros(count)
    if warm:
        nearby = given[0] * (1.0 + 1e-3 * np.random.default_rng(3).standard_normal(given[0].shape))
        solve(nearby, *given[1:], transition, guess, flows, iterations)
        guess = flows.copy()
    solve(*given, transition, guess, flows, iterations)
    return given, flows, iterations


@pytest.mark.parametrize("transition", [0.0, 9.33, 100.0])
@pytest.mark.parametrize("warm", [False, True])
def test_every_network_is_solved_within_its_iterations(transition: float, warm: bool):
    """Purely turbulent lands too, whose law has no slope at no flow: to 0.1 mPa, 2 to 5 iterations in the mean."""
    (free, impedance, areas, leaks), flows, iterations = solved(transition, warm)
    p = pressures_at(flows, free, impedance)
    drops = p[:, SOURCE] - p[:, SINK]
    at = taken(drops, areas, leaks, transition)
    around = (taken(drops + sign * 2.0 * TIGHT, areas, leaks, transition) for sign in (-1.0, 1.0))
    low, high = (flow + sign * (1e-12 * np.abs(at) + 1e-22) for flow, sign in zip(around, (-1.0, 1.0), strict=True))
    assert ((low <= flows) & (flows <= high)).all()
    assert iterations.max() < MOST_ITERATIONS
    assert iterations.mean() < (3.0 if warm else 5.0)


@pytest.mark.parametrize("transition", [0.0, 9.33])
def test_the_lands_only_take_energy(transition: float):
    """Sum of drop times flow over all lands, and so what they take from the ports, whatever the ports are."""
    (free, impedance, _, _), flows, _ = solved(transition, warm=False)
    p = pressures_at(flows, free, impedance)
    taken_power = ((p[:, SOURCE] - p[:, SINK]) * flows).sum(axis=1)
    assert (taken_power >= -5.0 * TIGHT * np.abs(flows).max(axis=1)).all()


def test_another_solver_finds_the_same():
    """scipy's `root` on the four port pressures, where it finds an answer at all: mostly, not always."""
    (free, impedance, areas, leaks), flows, _ = solved(9.33, warm=False, count=150)
    p = pressures_at(flows, free, impedance)
    agreed = 0
    for k in range(len(free)):

        def left(x: Array, k: int = k) -> Array:
            through = taken(x[SOURCE] * BAR - x[SINK] * BAR, areas[k], leaks[k], 9.33)
            return x - pressures_at(through[None], free[k : k + 1], impedance[k : k + 1])[0] / BAR

        found = root(left, np.maximum(free[k], VAPOUR) / BAR, method="hybr", options={"maxfev": 2000})
        if np.abs(left(found.x)).max() < 1e-9:
            agreed += 1
            assert found.x == pytest.approx(p[k] / BAR, rel=1e-7, abs=1e-7)
    assert agreed > 75


def test_where_lands_stand_apart_the_closed_form_is_the_same():
    edge = Orifice(0.61, 9.33)
    ports = Ports(Port(200 * BAR, 3e9), Port(60 * BAR, 2e10), Port(80 * BAR, 1e10), Port(2 * BAR, 4e9))
    for areas in (Lands(2e-5, 1e-5, 0.0, 0.0, 0.0), Lands(0.0, 0.0, 1e-6, 3e-5, 0.0)):
        laws = Laws(*(land_law(area, 0.0, edge, OIL) for area in areas))
        found, _ = network_flows(ports, laws, Lands(0.0, 0.0, 0.0, 0.0, 0.0), OIL)
        assert found == pytest.approx(land_flows(ports, areas, edge, OIL), rel=1e-9)


def test_a_land_with_its_leak_is_explicit_both_ways():
    """Flow of a drop is that of the orifice and the leak; the drop of that flow is the drop again."""
    edge = Orifice(0.61, 9.33)
    for area, leak in ((1e-5, 1e-13), (1e-9, 1e-12), (0.0, 1e-13), (2e-5, 0.0)):
        law = land_law(area, leak, edge, OIL)
        for drop in (-250 * BAR, -1.0, 3e-4, 70 * BAR):
            whole = land_flow(drop, law)
            assert whole == pytest.approx(flow(drop, area, edge, OIL) + leak * drop, rel=1e-12)
            assert land_drop(whole, law)[0] == pytest.approx(drop, rel=1e-12)


def test_ports_at_one_pressure_pass_nothing():
    """All shut, all open, or all under vapour: no iteration, no flow."""
    for c in (50 * BAR, -30 * BAR):
        ports = Ports(*(Port(c, 1e9 * k) for k in (1.0, 2.0, 3.0, 4.0)))
        for area in (0.0, 1e-5):
            laws = Laws(*[land_law(area, 1e-13, Orifice(0.61, 0.0), OIL)] * 5)
            assert network_flows(ports, laws, Lands(0.0, 0.0, 0.0, 0.0, 0.0), OIL) == (
                Lands(0.0, 0.0, 0.0, 0.0, 0.0),
                0,
            )
            assert port_pressures(Lands(0.0, 0.0, 0.0, 0.0, 0.0), ports, VAPOUR) == (max(c, VAPOUR),) * 4
