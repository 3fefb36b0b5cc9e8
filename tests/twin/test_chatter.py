"""Chatter, smooth: equilibrium, critical damping, soft or hard by two routes, orbits up to the seat, a line before."""

import math
from itertools import chain

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from twin.chatter import lyapunov
from twin.chatter.equilibrium import bare, critical_damping, crossing_speed, gains, growth, jacobian, onset, rest
from twin.chatter.grazing import averaged_grazing, grazing_damping, grazing_flow
from twin.chatter.inlet_line import InletLine, line_onsets
from twin.chatter.inlet_line import critical_damping as line_damping
from twin.chatter.line_run import run
from twin.chatter.orbit import curvature, follow, orbit, small, variation
from twin.chatter.system import CHAMFERED, CONICAL, SeatLaw, System, derivative, outflow

K = 2.32e-4
BETA = {CHAMFERED: 0.015132, CONICAL: 0.006538}
BOTH = pytest.mark.parametrize("law", [CHAMFERED, CONICAL], ids=["chamfered", "conical"])
CHANGE = {CHAMFERED: 2.763143, CONICAL: 4.602102}  # z of the soft-hard change, six digits
SYSTEMS = st.builds(
    System, st.sampled_from([CHAMFERED, CONICAL]), st.floats(1e-3, 5.0), st.floats(1e-4, 3.0),
    st.floats(0.0, 2.0, allow_subnormal=False),
    st.just(0.0), st.just(0.8),
)  # fmt: skip


def valve(law: SeatLaw, q: float, e: float, k: float = K) -> System:
    return System(law, BETA[law], q, e, k, 0.8)


@given(SYSTEMS)
@settings(max_examples=50)
def test_the_equilibrium_passes_the_flow(s: System):
    at = rest(s)
    assert outflow(at.lift, at.pressure, s.law) == pytest.approx(s.flow, rel=1e-12)
    assert at.pressure == at.lift + s.precompression


@given(SYSTEMS)
@settings(max_examples=50)
def test_at_k_crit_a_pair_is_imaginary_on_both_sides_of_it_not(s: System):
    start = onset(s)
    roots = np.linalg.eigvals(jacobian(s._replace(damping=start.damping)))
    pair = roots[np.abs(roots.imag) > 1e-6]
    assert pair.real == pytest.approx([0.0, 0.0], abs=1e-9)
    assert np.abs(pair.imag) == pytest.approx([start.frequency] * 2, rel=1e-9)
    d = 1e-4 * start.damping
    below, above = (growth(s._replace(damping=start.damping + sign * d)) for sign in (-1.0, 1.0))
    assert below > 0.0 > above
    assert (above - below) / (2.0 * d) == pytest.approx(start.speed, rel=1e-4)


@given(st.floats(1e-4, 50.0), st.sampled_from([CHAMFERED, CONICAL]))
@settings(max_examples=30)
def test_without_precompression_it_is_the_closed_form(z: float, law: SeatLaw):
    """(4.14), (4.15), (4.42), (4.43), and its inverse z^2 = w (w - 1)/(n + 1 - w) with w for omega^2."""
    n, s = law.lift / law.pressure, bare(z, law)
    assert gains(s) == pytest.approx((n * z, z), rel=1e-13)
    b = 1.0 + z * z
    printed = (-b + math.sqrt(b * b + 4.0 * n * z * z)) / (2.0 * z)
    assert onset(s).damping == pytest.approx(printed, rel=1e-6)  # the printed form cancels at small z
    w = onset(s).frequency ** 2
    assert w * (w - 1.0) / (n + 1.0 - w) == pytest.approx(z * z, rel=1e-6)


@BOTH
def test_the_need_for_damping_is_greatest_at_z_1(law: SeatLaw):
    most = {CHAMFERED: math.sqrt(3.0) - 1.0, CONICAL: 1.0}[law]
    speed = {CHAMFERED: -0.36603, CONICAL: -1.0 / 3.0}[law]
    start = onset(bare(1.0, law))
    assert start.damping == pytest.approx(most, rel=1e-14)
    assert start.speed == pytest.approx(speed, abs=5e-6)
    assert crossing_speed(1.0, law) == pytest.approx(0.0, abs=1e-15)
    n = law.lift / law.pressure
    for z in (0.3, 2.0):
        k = critical_damping(n * z, z)
        rates = [growth(bare(z + d, law)._replace(damping=k)) for d in (1e-5, -1e-5)]
        assert (rates[0] - rates[1]) / 2e-5 == pytest.approx(crossing_speed(z, law), rel=1e-5)


def test_precompression_raises_the_need_for_damping():
    """As q -> 0: chamfered k -> beta sqrt(e), conical -> 0."""
    for law in BETA:
        needs = [onset(valve(law, 0.1, e)).damping for e in (0.0, 0.5, 1.0, 1.5, 2.0)]
        assert needs == sorted(needs)
    assert onset(valve(CHAMFERED, 1e-8, 1.0)).damping == pytest.approx(BETA[CHAMFERED], rel=1e-3)
    assert onset(valve(CONICAL, 1e-8, 1.0)).damping < 1e-7


def test_derivatives_are_those_of_the_outflow():
    for law in (*BETA, SeatLaw(2.0, 0.7)):
        for i, j in ((1, 0), (0, 1), (1, 1)):
            d = 1e-4
            signs = [(a, b) for a in ((1, -1) if i else (0,)) for b in ((1, -1) if j else (0,))]
            difference = sum(
                (a or 1) * (b or 1) * outflow(0.7 + a * d, 1.3 + b * d, law) for a, b in signs
            ) / (2.0 * d) ** (i + j)  # fmt: skip
            assert derivative(0.7, 1.3, (i, j), law) == pytest.approx(difference, rel=1e-6)


@BOTH
def test_soft_turns_hard_at_the_same_z_by_projection_and_by_orbits(law: SeatLaw):
    """The orbits' own coefficient at the projection's root, over its slope: z to six digits by both."""
    z = lyapunov.change(law)
    assert z == pytest.approx(CHANGE[law], abs=5e-7)
    slope = (lyapunov.damping_by_amplitude(bare(1.01 * z, law)) - lyapunov.damping_by_amplitude(bare(z, law))) / (
        0.01 * z
    )
    assert abs(curvature(bare(z, law)) / slope) < 1e-6 * z
    assert lyapunov.first_coefficient(bare(0.99 * z, law)) < 0.0 < lyapunov.first_coefficient(bare(1.01 * z, law))


@pytest.mark.parametrize(("law", "z"), [(CHAMFERED, 0.5), (CONICAL, 0.5), (CONICAL, 6.0)])
def test_the_amplitude_law_of_projection_and_orbits_is_one(law: SeatLaw, z: float):
    s = bare(z, law)
    assert lyapunov.damping_by_amplitude(s) == pytest.approx(curvature(s), rel=2e-6)


def test_with_precompression_as_well():
    s = System(CONICAL, 0.8, 0.6, 1.0, 0.0, 0.8)
    assert lyapunov.damping_by_amplitude(s) == pytest.approx(curvature(s), rel=2e-6)


def test_small_z_the_chamfered_point_is_degenerate_the_conical_one_is_not():
    """dk/a^2 -> -11/2 z^5 and -21/8 z: the next order is z^2 smaller."""
    for z in (0.02, 0.05):
        assert lyapunov.damping_by_amplitude(bare(z, CHAMFERED)) / z**5 == pytest.approx(-5.5, rel=20 * z * z)
        assert lyapunov.damping_by_amplitude(bare(z, CONICAL)) / z == pytest.approx(-2.625, rel=20 * z * z)


def test_z_1_323_is_no_root_but_a_turned_sign_comes_near():
    """The chamfered coefficient at 1.323 is clearly negative. With the planar quadratic term turned round: 1.3253."""
    assert lyapunov.first_coefficient(bare(1.323, CHAMFERED)) < -0.02
    assert lyapunov.turned_change(CHAMFERED) == pytest.approx(1.3253, abs=1e-4)


def test_an_orbit_closes_and_its_variation_is_that_of_neighbours():
    s = bare(0.8, CONICAL)
    o = orbit(follow(small(s, 0.05), np.array([0.05, 0.2]), "damping")[-1], 0.3, "damping")
    end, by = variation(o.start, o.period, o.system, "damping")
    assert end == pytest.approx(o.start, abs=1e-11)
    d = 1e-6
    ahead, behind = (variation(o.start + sign * d * np.eye(3)[2], o.period, o.system, "damping")[0] for sign in (1, -1))
    assert (ahead - behind) / (2.0 * d) == pytest.approx(by[:, 2], rel=1e-6)


@pytest.mark.parametrize("e", [0.0, 1.0])
def test_the_conical_seat_touches_at_the_flow_of_averaging(e: float):
    """q by continuation and by averaging: they differ by the order z^2. Below it swings freely, and stably."""
    o = grazing_flow(valve(CONICAL, 1.0, e))
    q, m = averaged_grazing(valve(CONICAL, 1.0, e))
    assert o.system.flow == pytest.approx({0.0: 5.003674e-3, 1.0: 2.201096e-3}[e], rel=1e-6)
    assert q == pytest.approx(o.system.flow, rel=1e-6)
    assert onset(o.system).damping > K  # beyond the onset
    assert 0.5 * (o.start[0] + variation(o.start, 0.5 * o.period, o.system, "flow")[0][0]) == pytest.approx(m, rel=1e-3)


def test_the_chamfered_orbit_grows_to_the_seat_at_once():
    """Grazing and k_crit differ by parts in 1e8: soft by the letter, a jump in practice."""
    for e, share in ((0.0, 4e-10), (1.0, 1.043e-7)):
        o = grazing_damping(valve(CHAMFERED, 0.1, e))
        assert 1.0 - o.system.damping / onset(o.system).damping == pytest.approx(share, rel=0.05)
    with pytest.raises(ValueError, match="the valve always sings"):
        grazing_flow(valve(CHAMFERED, 1.0, 1.0))


LINE = InletLine(1.9, 5400.0, 0.25, "unsteady", "pressure", 0.0)


def test_a_short_line_is_its_volume():
    """As T -> 0 the shut far end gives b Y -> s, with beta of the line's own oil."""
    s, t = valve(CONICAL, 0.1, 0.0), 0.01
    line = InletLine(t, 1e9, s.beta * t, "none", "flow", 0.0)  # beta T/Z0 = 1
    assert line_damping(s, line) == pytest.approx(onset(s).damping, rel=1e-4)
    assert line_damping(s, line._replace(impedance=1e6, volume=1.0)) == pytest.approx(onset(s).damping, rel=1e-6)


@pytest.mark.parametrize("far_end", ["pressure", "flow"])
def test_with_a_line_the_valve_sings_above_its_own_frequency(far_end: str):
    s = valve(CHAMFERED, 0.03, 0.0)
    lines = [LINE._replace(travel_time=t, far_end=far_end) for t in (1.0, 1.9, 5.0)]
    starts = [line_onsets(s, line) for line in lines]
    assert sum(map(bool, starts)) >= 2  # near a quarter wave to a shut end the valve is calm
    for start in chain.from_iterable(starts):
        assert 1.0 < start.frequency < math.sqrt(3.0)
        assert start.speed < 0.0


@pytest.mark.parametrize("law", [CHAMFERED, CONICAL])
def test_a_line_of_ours_sings_on_one_side_of_the_theory_and_not_on_the_other(law: SeatLaw):
    """Growth over time against the crossing speed, 10 % below and above k_crit of the quarter wave."""
    s = valve(law, 0.05, 0.0)
    start = line_onsets(s, LINE)[0]
    assert start.damping > 20.0 * onset(s).damping  # what the lumped volume asks for
    for share in (0.9, 1.1):
        damped = s._replace(damping=share * start.damping)
        swing = np.abs(run(damped, LINE, 300.0, 0.02) / rest(s).lift - 1.0)
        early, late = swing[5000:7500].max(), swing[-2500:].max()
        rate = math.log(late / early) / (0.02 * (len(swing) - 7500))
        assert rate == pytest.approx(start.speed * (share - 1.0) * start.damping, rel=0.25)


def test_what_cannot_be_is_refused():
    with pytest.raises(ValueError, match="needs a flow"):
        rest(valve(CONICAL, 0.0, 0.0))
    with pytest.raises(ValueError, match="far end 'open' is none"):
        line_onsets(valve(CONICAL, 0.1, 0.0), LINE._replace(far_end="open"))
    with pytest.raises(ValueError, match=r"volume 1\.0 at the valve"):
        run(valve(CONICAL, 0.1, 0.0), LINE._replace(volume=1.0), 1.0, 0.02)
    with pytest.raises(ValueError, match="only the conical seat"):
        averaged_grazing(valve(CHAMFERED, 0.1, 0.0))
