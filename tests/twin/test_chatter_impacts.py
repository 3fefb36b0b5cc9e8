"""Chatter with impacts: exact instants, period-one orbits from two tolerances, what ends where."""

import math

import numpy as np
import pytest

from twin.chatter.basin import CALM, HITS, SWINGS, basin, bifurcation, boundary_flow, chart
from twin.chatter.equilibrium import bare, onset, rest
from twin.chatter.flight import HIT, TOP, Point, advance, bounce, move, seated
from twin.chatter.grazing import grazing_damping, grazing_flow
from twin.chatter.impact import impact_orbit, motion, orbit_error
from twin.chatter.lyapunov import change
from twin.chatter.orbit import follow, small
from twin.chatter.system import CHAMFERED, CONICAL, SeatLaw, System

K = 2.32e-4
BETA = {CHAMFERED: 0.015132, CONICAL: 0.006538}
ORBITS = {  # q, e: highest lift, period, impact speed
    CHAMFERED: {(0.1, 0.0): (0.4126485, 5.7292848, 0.063931), (0.5, 1.0): (0.7690287, 5.4271439, 0.185930)},
    CONICAL: {(0.25, 0.0): (1.1098368, 5.8388938, 0.137589), (0.5, 1.0): (0.9942168, 5.6352665, 0.180674)},
}


def valve(law: SeatLaw, q: float, e: float, k: float = K) -> System:
    return System(law, BETA[law], q, e, k, 0.8)


def test_a_step_has_order_5():
    s, start = valve(CHAMFERED, 0.5, 0.3, 0.1)._replace(beta=1.0), (0.7, 0.4, 1.1)

    def end(steps: int) -> np.ndarray:
        y = start
        for _ in range(steps):
            y = move(*y, 2.0 / steps, s)[:3]
        return np.array(y)

    fine = end(640)
    errors = [np.abs(end(n) - fine).max() for n in (10, 20, 40)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(5.0, abs=0.4)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(5.0, abs=0.3)


def test_events_are_at_their_own_instants():
    """Without oil (beta 0) and damping the poppet is a harmonic oscillator: y1 = p + A sin(t - t0) with p = y3 - e."""
    s = System(CHAMFERED, 0.0, 1.0, 1.0, 0.0, 0.8)
    p, speed = 0.3, 2.0  # y3 = 1.3, released from the seat
    at = advance(Point(0.0, 0.0, speed, 1.3, 0.1, 0.0), 1e9, 1e-13, s)
    reach, phase = math.hypot(p, speed), math.atan2(p, speed)
    assert (at.event, at.time) == (TOP, pytest.approx(0.5 * math.pi + phase, abs=1e-11))
    assert at.y1 == pytest.approx(p + reach, abs=1e-12)
    at = advance(at, 1e9, 1e-13, s)
    assert (at.event, at.y1, at.time) == (HIT, 0.0, pytest.approx(math.pi + 2.0 * phase, abs=1e-11))
    assert at.y2 == pytest.approx(-speed, abs=1e-12)
    at = bounce(at, 1.0, s)
    assert at.y2 == pytest.approx(0.8 * speed, abs=1e-12)


def test_a_graze_within_a_step_is_seen():
    """The lowest lift lies 1e-6 below the seat, inside a step whose ends both lie above it."""
    s = System(CHAMFERED, 0.0, 1.0, 0.0, 0.0, 0.8)
    low = advance(Point(0.0, 1.0, 0.0, 0.5 - 1e-6 / 2, 0.5, 0.0), 1e9, 1e-9, s)
    assert low.event == HIT
    clear = advance(Point(0.0, 1.0, 0.0, 0.5 + 1e-6, 0.5, 0.0), 1e9, 1e-9, s)
    assert clear.event == TOP


def test_a_shut_valve_waits_for_its_pressure():
    s = valve(CONICAL, 0.2, 1.0)
    assert seated(0.4, s).time == pytest.approx(0.6 / (s.beta * 0.2))
    at = bounce(Point(0.0, 0.0, -1e-12, 0.4, 1e-3, HIT), 1.0, s)
    assert (at.time, at.y2, at.y3) == (pytest.approx(0.6 / (s.beta * 0.2)), 0.0, 1.0)


@pytest.mark.parametrize("law", [CHAMFERED, CONICAL], ids=["chamfered", "conical"])
def test_impact_orbits_and_their_error(law: SeatLaw):
    """Two tolerances, a thousand apart, agree to 1e-6; the tops of a long run are the orbit's."""
    for (q, e), (lift, period, impact) in ORBITS[law].items():
        s = valve(law, q, e)
        o = impact_orbit(s)
        assert (o.lift, o.period, o.impact) == pytest.approx((lift, period, impact), rel=1e-6, abs=5e-7)
        assert max(orbit_error(s)[:4]) < 1e-6
        assert o.multiplier < 1.0 < o.frequency
        run = motion(s, (0.0, 0.0, e), 1500, 3)
        assert run.lift == pytest.approx([o.lift] * 3, rel=1e-6)
        assert np.diff(run.time) == pytest.approx([o.period] * 2, rel=1e-6)


def test_impact_raises_the_frequency_above_the_free_one():
    """1392 Hz; more flow, more so."""
    found = [impact_orbit(valve(CHAMFERED, q, 1.0)).frequency for q in (0.01, 0.1, 0.5)]
    assert 1.1 < found[0] < found[1] < found[2] < 1.2


def test_at_the_grazing_flow_impacts_begin():
    """On both sides of it, by continuation and by long runs: free below, impacts above, the lift continuous."""
    q = grazing_flow(valve(CONICAL, 1.0, 0.0)).system.flow
    below, above = impact_orbit(valve(CONICAL, 0.97 * q, 0.0), settle=60000), valve(CONICAL, 1.03 * q, 0.0)
    assert below.impact == 0.0
    assert below.lift < 2.0 * rest(valve(CONICAL, q, 0.0)).lift
    assert motion(above, (2.2 * rest(above).lift, 0.0, rest(above).pressure), 20000, 50, 1e-8).hits.any()


def test_a_chart_has_the_linear_boundary_and_the_grazing_one():
    """Conical, q = 0.1: calm above k_crit, impacts below the damping of the grazing orbit, free swings between."""
    s = valve(CONICAL, 0.1, 0.0)
    k, graze = onset(s).damping, grazing_damping(s).system.damping
    dampings = np.array([0.9 * graze, 1.1 * graze, 0.97 * k, 1.05 * k])
    kind, top = chart(s, np.array([0.1]), dampings, shut=False, most=30000)
    assert kind[:, 0].tolist() == [HITS, SWINGS, SWINGS, CALM]
    assert top[0, 0] == pytest.approx(2.0 * 0.4**0.25, rel=0.02)  # of the grazing orbit, by averaging
    assert 1.0 < top[2, 0] < top[1, 0] < 2.0
    assert boundary_flow(kind, np.array([0.1]))[0] == 0.1
    assert math.isnan(boundary_flow(kind, np.array([0.1]))[3])


def test_where_the_loss_is_hard_the_start_decides():
    """Chamfered, z above the change: a stable rest and impacts side by side, the unstable orbit between them."""
    z = 1.6 * change(CHAMFERED)
    k = onset(bare(z, CHAMFERED)).damping
    edge = follow(small(bare(z, CHAMFERED), 0.02), np.array([0.02, 0.06, 0.1]), "damping")[-1]
    assert edge.system.damping > k  # the unstable orbit lives where the equilibrium is stable
    s = edge.system._replace(restitution=0.8)
    found = basin(s, np.array([1.02, 1.9]), np.array([0.0]))
    assert found[0, 0] == CALM
    assert found[0, 1] != CALM


def test_a_bifurcation_diagram_holds_the_tops_of_each_flow():
    s = valve(CHAMFERED, 1.0, 1.0)
    flow, top, impact = bifurcation(s, np.array([0.1, 0.5]), 1500, 4)
    assert flow.tolist() == [0.1] * 4 + [0.5] * 4
    assert top[4:] == pytest.approx(0.7690287, rel=1e-4)
    assert impact[4:] == pytest.approx(0.185930, rel=1e-4)


def test_what_has_no_period_one_orbit_says_so():
    with pytest.raises(ValueError, match=r"no period-one orbit at q = 0\.1"):
        impact_orbit(valve(CONICAL, 0.1, 0.0, k=0.1), settle=2000)


def test_a_valve_that_creeps_to_its_rest_without_a_swing_is_calm():
    """Damping 5 and more: no top ever comes, and the run ends all the same."""
    for damping in (5.0, 20.0):
        s = System(CHAMFERED, 1.0, 1.0, 1.0, damping, 0.8)
        assert basin(s, np.array([1.5]), np.zeros(1)).tolist() == [[CALM]]
        with pytest.raises(ValueError, match="no period-one orbit"):
            impact_orbit(s, settle=10)
