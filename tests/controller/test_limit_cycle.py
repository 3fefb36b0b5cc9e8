"""Periodic orbits of the analogue loop against scipy, closed forms, finite differences and plain runs of the loop."""

import math

import numpy as np
import pytest
from scipy.integrate import quad_vec

from controller.stability.actuator.model import mirror
from controller.stability.orbits.arc import (
    CROSSED,
    follow,
)
from controller.stability.orbits.birth import (
    proportional_birth,
    relay_birth,
)
from controller.stability.orbits.continuation import Branch, Limits, follow_branch
from controller.stability.orbits.floquet import (
    attracts,
    orbit_multipliers,
    other_multipliers,
    peaks,
    profile,
    samples,
)
from controller.stability.orbits.limit_cycle import (
    Orbit,
    as_two_arcs,
    equations,
    pack,
    solve,
    with_gain,
)
from tests.support.orbits import (
    FALLING,
    MOST,
    PLANT,
    D,
    S,
    proportional_branch,
    rates,
    relay_branch,
    run,
    run_stiff,
)
from twin.integration import integrate


@pytest.fixture(scope="module")
def orbits() -> dict[str, Orbit]:
    """Of the relay with pressures inside, and passing supply; of the proportional valve; of crossed edges."""
    return {
        "relay": relay_branch(PLANT, 0.25, 1.0).orbits[-1],
        "passing": relay_branch(PLANT, 0.15, 1.0).orbits[-1],
        "proportional": proportional_branch(1.8).orbits[-1],
        "crossed": proportional_branch(1.2, CROSSED).orbits[-1],
    }


@pytest.fixture(scope="module")
def folded() -> Branch:
    return relay_branch(FALLING, 0.0, 0.3, 0.8)


@pytest.mark.parametrize("name", ["relay", "passing", "proportional", "crossed"])
def test_an_orbit_returns_to_itself(orbits: dict[str, Orbit], name: str):
    """By scipy at 1e-11, with the root itself where the orbit was found with an edge laminar at 1e-9 of the supply.

    Through the supply by Radau, with an edge laminar at 1e-11.
    """
    orbit = orbits[name]
    y = orbit.starts[0]
    for side in (1.0, -1.0):
        y = (run_stiff if name == "passing" else run)(orbit, y, side, orbit.lengths[0]).y[:, -1]
    assert y == pytest.approx(orbit.starts[0], abs=1e-8)
    assert y[:2] == pytest.approx(orbit.starts[0, :2], abs=1e-11)
    s, d = orbit.loop.gains
    assert s * y[0] + d * y[1] == pytest.approx(0.0, abs=1e-10)


def test_the_equations_have_the_derivatives_they_say(orbits: dict[str, Orbit]):
    """Central differences of 1e-6, relative to what each unknown is; two arcs that are no orbit."""
    for name, parameter in (("relay", "d"), ("proportional", "s"), ("crossed", "s")):
        orbit = as_two_arcs(orbits[name])
        x = pack(orbit, parameter) * (1.0 + 0.02 * np.random.default_rng(3).normal(size=11))
        slopes = equations(x, orbit.loop, parameter)[1]
        for j, unit in enumerate(np.eye(11)):
            step = 1e-6 * max(abs(x[j]), 1e-3)
            seen = np.subtract(*(equations(x + sign * step * unit, orbit.loop, parameter)[0] for sign in (1, -1)))
            assert seen / (2.0 * step) == pytest.approx(slopes[:, j], rel=1e-4, abs=2e-4)


@pytest.mark.parametrize("name", ["relay", "proportional"])
def test_multipliers_are_those_of_the_motion_over_a_period(orbits: dict[str, Orbit], name: str):
    """Central differences of scipy's run over a period from the middle of an arc, through the switchings."""
    orbit = orbits[name]
    middle = samples(orbit, 0, 2)[1][1]
    size = 1e-4 * np.append(peaks(orbit)[:2], [1.0, 1.0])

    def turned(y: np.ndarray) -> np.ndarray:
        time, side = 0.0, 1.0
        for _ in range(4):
            piece = run(orbit, y, side, orbit.period - time, to_switch=True)
            y, time, side = piece.y[:, -1], time + piece.t[-1], -side
            if piece.status == 0:
                return y
        raise AssertionError(f"switched four times before {time:.6g} of {orbit.period:.6g}")

    seen = np.array([turned(middle + e) - turned(middle - e) for e in np.diag(size)]).T / (2.0 * size)
    assert np.sort(np.linalg.eigvals(seen)) == pytest.approx(np.sort(orbit_multipliers(orbit)), abs=2e-5)
    assert np.abs(orbit_multipliers(orbit) - 1.0).min() < 1e-8


@pytest.mark.parametrize("name", ["relay", "proportional", "crossed"])
def test_the_product_of_the_multipliers_is_what_the_field_does_to_volumes(orbits: dict[str, Orbit], name: str):
    """Liouville: exp of the divergence over the period; a switch adds nothing, its saltation has determinant 1."""
    orbit = orbits[name]
    (alpha, gamma, k), (s, d) = orbit.loop.actuator, orbit.loop.gains

    def divergence(time: float) -> float:
        y1, y2, y3, y4 = follow(orbit.starts[0], max(time, 1e-12), orbit.loop, 1e-11, False)[0][:4]
        u = 1.0 if name == "relay" else -(s * y1 + d * y2)
        low, high = (y3, 1.0 - y4) if name == "crossed" else (1.0 - y3, y4)
        sign = -1.0 if name == "crossed" else 1.0
        return -k - sign * gamma * u / (2.0 * alpha) * (low**-0.5 / (1.0 + y1) + high**-0.5 / (1.0 - y1))

    area = quad_vec(divergence, 0.0, orbit.lengths[0], epsrel=1e-9)[0]
    assert np.prod(orbit_multipliers(orbit)).real == pytest.approx(math.exp(2.0 * area), rel=1e-6)


def test_an_orbit_through_the_supply_forgets_its_pressures(orbits: dict[str, Orbit]):
    """Two multipliers are 0; where the edge becomes laminar does not matter."""
    orbit = orbits["passing"]
    assert peaks(orbit)[2] > 1.0
    assert np.abs(orbit_multipliers(orbit)[2:]).max() < 1e-12
    coarse = solve(orbit._replace(loop=orbit.loop._replace(laminar=1e-7)))
    assert coarse.lengths == pytest.approx(orbit.lengths, rel=1e-6)
    assert other_multipliers(coarse)[0] == pytest.approx(other_multipliers(orbit)[0], abs=1e-5)


def test_greatest_values_are_those_of_a_fine_run(orbits: dict[str, Orbit]):
    orbit = orbits["proportional"]
    span = 0.0, orbit.period
    limits = {"rtol": 1e-10, "atol": 1e-12, "max_step": 0.01}
    fine = integrate(rates(orbit, 1.0), span, orbit.starts[0], "DOP853", most=MOST, **limits)
    assert peaks(orbit) == pytest.approx(fine.y.max(axis=1), rel=1e-4)
    times, states = profile(orbit, 8)
    assert times[-1] == pytest.approx(orbit.period, rel=1e-12)
    assert states[-1] == pytest.approx(states[0], abs=1e-9)
    assert states[4] == pytest.approx(mirror(states[13]), abs=1e-9)


@pytest.mark.parametrize(("name", "parameter"), [("relay", "d"), ("proportional", "s")])
def test_two_free_arcs_find_the_symmetric_orbit(orbits: dict[str, Orbit], name: str, parameter: str):
    """From a guess 1 % off, each arc its own way: no other orbit is near. Same multipliers."""
    both, shake = as_two_arcs(orbits[name]), np.random.default_rng(1)
    found = solve(
        both._replace(
            starts=both.starts * (1.0 + 0.01 * shake.normal(size=(2, 4))), lengths=both.lengths * np.array([1.02, 0.99])
        ),
        parameter,
    )
    assert found.starts == pytest.approx(both.starts, rel=1e-8)
    assert found.lengths == pytest.approx(both.lengths, rel=1e-8)
    assert orbit_multipliers(found) == pytest.approx(orbit_multipliers(orbits[name]), abs=1e-7)


def test_the_branches_of_the_thesis():
    """Fig. 5.4 at d = 0, and both halves of Fig. 5.5: T 2.165 at s = 2; 2.195 at s = 1, with crossed edges."""
    relay = relay_branch(PLANT, 0.0, 1.0)
    assert relay.attracts.all()
    assert not relay.folds
    assert peaks(relay.orbits[-1])[:2] == pytest.approx([3.8e-4, 2.68e-3], rel=0.02)
    above, below = proportional_branch(2.0), proportional_branch(1.0, CROSSED)
    assert above.attracts.all()
    assert not below.attracts.any()
    assert not above.folds + below.folds
    assert above.periods[-1] / 2.0 == pytest.approx(2.1645, abs=5e-4)
    assert below.periods[-1] / 2.0 == pytest.approx(2.1956, abs=5e-4)
    assert (np.diff(above.values) > 0.0).all()
    assert (np.diff(below.values) < 0.0).all()


def test_a_branch_folds_where_a_multiplier_passes_one(folded: Branch):
    """The relay with falling friction: d turns, one multiplier passes +1, the orbit of longer period repels."""
    assert len(folded.folds) == 1
    fold = folded.folds[0]
    assert fold.loop.gains.d <= folded.values.min()
    pair = orbit_multipliers(fold)[:2]
    assert np.prod(pair).real == pytest.approx(1.0, abs=1e-6)
    assert np.abs(pair - 1.0).max() < 1e-3  # a double 1 splits by the root of the error
    short = folded.periods < fold.period
    assert (folded.attracts == short).all()
    assert short.any()
    assert not short.all()
    largest = folded.multipliers[:, 0].real
    assert largest[short].max() < 1.0 < largest[~short].min()


def half_turns(orbit: Orbit, start: np.ndarray, count: int) -> np.ndarray:
    """y2 at `count` switchings of scipy's run, each as seen before its mirror."""
    seen, y = [], start
    for _ in range(count):
        y = mirror(run_stiff(orbit, y, 1.0, 20.0 * orbit.lengths[0], to_switch=True).y[:, -1])
        seen.append(y[1])
    return np.array(seen)


def test_plain_runs_leave_an_unstable_orbit_by_its_multiplier_and_come_to_a_stable_one(folded: Branch):
    """Started 0.1 % beside it in y1 and y2: a half-turn multiplies the gap by the root of the multiplier."""
    repelling, attracting = folded.orbits[-1], folded.orbits[-1]
    for orbit in folded.orbits:
        if orbit.period < folded.folds[0].period and peaks(orbit)[2] > 1.0:
            attracting = orbit
    for orbit in (repelling, attracting):
        factor = math.sqrt(other_multipliers(orbit)[0].real)
        for shift in (1e-3, -1e-3) if orbit is repelling else (1e-3,):
            start = orbit.starts[0] * [1.0 + shift, 1.0 + shift, 1.0, 1.0]
            gaps = half_turns(orbit, start, 3) / orbit.starts[0, 1] - 1.0
            assert gaps[2:] / gaps[1:-1] == pytest.approx(factor, rel=0.02)
    assert not attracts(repelling)
    assert attracts(attracting)


def test_what_has_no_orbit_is_refused():
    with pytest.raises(ValueError, match=r"with k above 0, not with k -0\.2"):
        proportional_birth(FALLING, D, 1e-6)
    orbit = relay_birth(PLANT, S, 0.01)
    with pytest.raises(ArithmeticError, match=r"Newton's method does not converge|length .* must be above 0"):
        solve(orbit._replace(loop=with_gain(orbit.loop, "d", 0.3)))
    with pytest.raises(ValueError, match=r"d 0\.27\d+, period 0\.02 of the first orbit must lie within 0\.0 \.\. 0\.1"):
        follow_branch(orbit, "d", -1.0, Limits(0.0, 0.1, 1.0, 0.05, 10))
