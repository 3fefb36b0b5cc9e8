"""The filter's algebra by closed forms, and members that a twin could have come to."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests.support.plant import circuit, cylinder_of, load_of
from twin.circuit.block import compiled
from twin.circuit.equilibrium import equilibrium
from twin.circuit.state import flatten, unflatten
from twin.cylinder import Chambers
from twin.estimation.admissible import admit
from twin.estimation.consistency import BAD, GOOD, STUCK, Watch, stated
from twin.estimation.draws import Draws, exact
from twin.estimation.filter import Filter, fewest
from twin.estimation.quantities import UNKNOWNS, Use
from twin.estimation.settings import Settings
from twin.estimation.transform import BLOCK, apply, combine, fade
from twin.estimation.unknowns import Prior, Unknowns, priors
from twin.sensors import Card
from twin.topology import CHANNELS

CIRCUIT = circuit()
MEMBERS, STATES, READINGS = 9, 150, 5


def ensemble(seed: int) -> np.ndarray:
    """Members of correlated states; one of them is the same in all."""
    rng = np.random.default_rng(seed)
    states = rng.normal(size=(MEMBERS, 6)) @ rng.normal(size=(6, STATES)) + rng.normal(size=STATES)
    states[:, 7] = 0.1
    return states


def analysed(states: np.ndarray, h: np.ndarray, d: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The members after an analysis, and the whitened innovations."""
    after, change, missed = states.copy(), np.zeros((MEMBERS, MEMBERS)), np.zeros(len(d))
    y = np.array([states @ row for row in h])
    combine(y, d, r, np.zeros(MEMBERS), np.zeros((MEMBERS, MEMBERS)), change, missed, np.zeros((MEMBERS, 0)))
    apply(after, change, 1.0, np.zeros((MEMBERS + 1, BLOCK)))
    return after, missed


def test_an_analysis_is_kalmans():
    """Mean and covariance of the members are K(d - Hx) and (1 - KH)P of their own P, whatever their number."""
    rng, states = np.random.default_rng(3), ensemble(2)
    h, d, r = rng.normal(size=(READINGS, STATES)), rng.normal(size=READINGS), rng.uniform(0.5, 2.0, READINGS)
    mean, p = states.mean(axis=0), np.cov(states.T)
    s = h @ p @ h.T + np.diag(r)
    gain = p @ h.T @ np.linalg.inv(s)
    after, missed = analysed(states, h, d, r)
    assert_allclose(after.mean(axis=0), mean + gain @ (d - h @ mean), atol=1e-10)
    assert_allclose(np.cov(after.T), p - gain @ h @ p, atol=1e-10)
    away = d - h @ mean
    assert missed @ missed == pytest.approx(away @ np.linalg.solve(s, away), rel=1e-9)  # whitened: one and the same NIS


def told(z: np.ndarray, y: np.ndarray, d: np.ndarray) -> None:
    """Update unknowns by readings of variance 1, one after the other."""
    n = len(z)
    for row, reading in zip(y, d, strict=True):
        work = np.zeros(n), np.zeros((n, n)), np.zeros((n, n)), np.zeros(1)
        combine(row[None, :].copy(), np.array([reading]), np.ones(1), *work, z)


def test_an_unknown_that_readings_are_about_is_found_as_kalman_finds_it():
    """A number read ten times with noise: its mean and its variance 1/(1 + 10) are those of Bayes."""
    rng = np.random.default_rng(8)
    z, readings = exact_normal(rng, 24), 0.7 + rng.normal(size=10)
    for reading in readings:
        told(z, z.T.copy(), np.array([reading]))
    assert z.mean() == pytest.approx(readings.sum() / 11.0, abs=1e-12)
    assert z.var(ddof=1) == pytest.approx(1.0 / 11.0, rel=1e-12)


def test_an_unknown_that_readings_say_nothing_of_keeps_most_of_its_deviation():
    """Of 24 members and 100 readings of something else: by its plain correlations it would keep 1 part in 3."""
    for seed in range(5):
        rng = np.random.default_rng(seed)
        z = exact_normal(rng, 24)
        told(z, rng.normal(size=(100, 24)), rng.normal(size=100))
        assert z.std(ddof=1) > 0.4


def exact_normal(rng: np.random.Generator, n: int) -> np.ndarray:
    """A column of mean 0 and variance 1."""
    z = rng.normal(size=(n, 1))
    return (z - z.mean()) / z.std(ddof=1)


def test_what_readings_have_said_fades_and_what_was_known_beforehand_does_not():
    """Information is kept by a share, and the rest of it is that of the prior: normal densities, p^k p0^(1 - k)."""
    z = exact_normal(np.random.default_rng(5), 24) * [0.1, 3.0, 0.4] + [0.6, -5.0, 0.2]
    m, p, prior, kept = z.mean(axis=0), z.var(axis=0, ddof=1), np.array([0.5, 0.5, 0.0]), 0.9
    fade(z, prior, kept)
    informed = kept / p[:2] + (1.0 - kept) / prior[:2] ** 2
    assert_allclose(z.var(axis=0, ddof=1)[:2], 1.0 / informed, rtol=1e-12)
    assert_allclose(z.mean(axis=0)[:2], kept * (m / p)[:2] / informed, rtol=1e-12)
    assert_allclose(z[:, 2].mean(), m[2])  # certain beforehand: its drift alone says what it may have done
    assert_allclose(z[:, 2].var(ddof=1), p[2])


def test_an_unknown_of_which_nothing_is_read_goes_back_to_what_was_known_of_it():
    """However far it was: over hours nothing of it runs away."""
    z = exact_normal(np.random.default_rng(5), 24)[:, :1] * 0.02 + 4.0
    for _ in range(4000):  # of 5 ms at a growth of 1/s
        fade(z, np.array([0.5]), math.exp(-0.01))
    assert z.std(ddof=1) == pytest.approx(0.5, rel=1e-6)
    assert z.mean() == pytest.approx(0.0, abs=1e-6)


def test_what_is_not_read_changes_nothing():
    states = ensemble(4)
    h = np.random.default_rng(5).normal(size=(2, STATES))
    one, _ = analysed(states, h[:1], np.array([0.3]), np.array([1.0]))
    both, missed = analysed(states, h, np.array([0.3, math.nan]), np.array([1.0, math.nan]))
    assert (one == both).all()
    assert math.isnan(missed[1])


def test_what_all_members_share_stays_to_the_bit():
    states = ensemble(6)
    after, _ = analysed(states, np.ones((1, STATES)), np.array([2.0]), np.array([0.1]))
    assert (after[:, 7] == states[:, 7]).all()


def test_anomalies_are_stretched_about_the_mean():
    states = ensemble(7)
    after = states.copy()
    apply(after, np.zeros((MEMBERS, MEMBERS)), 1.1, np.zeros((MEMBERS + 1, BLOCK)))
    assert_allclose(after.mean(axis=0), states.mean(axis=0), atol=1e-12)
    assert_allclose(after.std(axis=0), 1.1 * states.std(axis=0), atol=1e-12)


def test_deviates_are_exact_and_independent_of_what_is_there():
    there, drawn = Draws(1, 4, 20).at(0), Draws(1, 5, 20).at(1)
    before = there.copy()
    exact(there, drawn)
    assert_allclose(drawn.mean(axis=1), 0.0, atol=1e-12)
    assert_allclose(np.cov(drawn), np.eye(5), atol=1e-12)
    assert_allclose(drawn @ (before - before.mean(axis=1, keepdims=True)).T, 0.0, atol=1e-10)


def test_the_fewest_members_leave_each_draw_its_variance():
    """Unknowns that are there, as many that drift, and the noises of the state, of which one fewer loses the last."""
    noises, unknowns = 4, 13
    assert fewest(Settings(position_noise=0.0), unknowns) == fewest(Settings(), unknowns) - 1
    least = fewest(Settings(), unknowns)
    for members, last in ((least, 1.0), (least - 1, 0.0)):
        there, drawn = Draws(1, unknowns, members).at(0), Draws(1, unknowns + noises, members).at(1)
        exact(there, drawn)
        assert_allclose(drawn.var(axis=1, ddof=1), [1.0] * (unknowns + noises - 1) + [last], atol=1e-9)


def test_members_have_their_own_numbers_and_the_rest_of_the_rig():
    names = ("leakage", "load_force")
    unknowns = Unknowns(CIRCUIT.parts, names, 2)
    unknowns.write(np.array([[0.0, 0.0], [math.log(2.0), 50.0]]))
    leak, force, mass = CIRCUIT.parts.cylinder.leakage, load_of(CIRCUIT).force, load_of(CIRCUIT).mass
    assert unknowns.records["cylinder"]["leakage"].tolist() == pytest.approx([leak, 2.0 * leak], rel=1e-15)
    assert unknowns.records["load"]["force"].tolist() == [force, force + 50.0]
    assert unknowns.records["load"]["mass"].tolist() == [mass, mass]


def test_what_is_certain_is_no_unknown():
    found = priors(CIRCUIT.parts, {"leakage": Prior(0.0, 0.0), "offset_p2": Prior(1e5, 0.0)})
    assert "leakage" not in found
    assert "offset_p2" in found
    assert set(found) <= set(UNKNOWNS)


def test_a_combination_is_made_a_state_that_a_twin_can_have():
    """The oil of a chamber is that of its pressure at the new place; bounds hold; the same again changes nothing."""
    state = flatten(equilibrium(CIRCUIT, 0.1))
    state[1] = 0.1003  # the position
    state[10] = -1e-6  # the pilot's lift
    ends = unflatten(state).ends
    members = np.repeat(state[None, :], 2, axis=0)
    unknowns, plant = Unknowns(CIRCUIT.parts, (), 2), compiled(CIRCUIT)
    admit(unknowns.records, plant.whole, plant.numbers, members)
    once = members.copy()
    admit(unknowns.records, plant.whole, plant.numbers, members)
    assert (members == once).all()
    found, cylinder = unflatten(members[0]), cylinder_of(CIRCUIT)
    p_lower = float(ends.pressure[5])
    volume = cylinder.dead_lower + cylinder.area_lower * 0.1003
    assert found.core.chambers.lower == pytest.approx(volume * (1.0 + p_lower / cylinder.bulk_modulus), rel=1e-14)
    assert isinstance(found.core.chambers, Chambers)
    assert found.core.relief.state.pilot_lift == 0.0


def test_a_deviation_is_stated_by_what_the_innovations_say():
    """Information that readings gave by their mean square, that from beforehand as it is, a wider spread as it is."""
    spread, prior = np.array([0.1, 0.3, 0.5, 0.0]), np.array([0.2, 0.3, 0.2, 0.2])
    of_both = (1.0 / 0.2**2 + (1.0 / 0.1**2 - 1.0 / 0.2**2) / 0.25) ** -0.5
    assert_allclose(stated(spread, prior, 0.25), [of_both, 0.3, 0.5, 0.0], rtol=1e-12)
    assert_allclose(stated(spread, prior, 4.0), 2.0 * spread)


def test_a_channel_is_left_out_and_taken_again():
    watch = Watch(0.5, (0.0, 10.0))
    assert watch.look(1.0, 1.0, alone=True) == 0.0
    assert watch.look(1.1, 6.0, alone=True) == pytest.approx(3.0)  # 6 deviations count as three: (1 + 3) times variance
    assert math.isnan(watch.look(4.9, 50.0, alone=True))
    assert watch.use is Use.SPIKE
    for k in range(1, BAD):
        watch.look(5.0 + 0.1 * k, 50.0, alone=True)
    assert watch.use is Use.OFF
    for k in range(GOOD):
        assert watch.use is Use.OFF
        watch.look(1.0 + 0.01 * k, 0.5, alone=True)
    assert watch.use is Use.USED


def test_where_many_channels_are_far_away_the_model_is_wrong_and_all_are_used():
    watch = Watch(0.5, (0.0, 10.0))
    for k in range(2 * BAD):
        assert not math.isnan(watch.look(5.0 + 0.1 * k, 50.0, alone=False))
        assert watch.use is Use.USED


def test_a_channel_that_is_left_out_stays_so_while_readings_are_missing():
    """And until several have been far away for as long as it takes to come back: then the model is wrong."""
    watch = Watch(0.5, (0.0, 10.0))
    for k in range(BAD):
        watch.look(5.0 + 0.1 * k, 50.0, alone=True)
    for k in range(2 * GOOD):
        assert math.isnan(watch.look(5.0 + 0.1 * k if k % 7 else math.nan, 50.0, alone=True))
        assert watch.use is (Use.OFF if k % 7 else Use.MISSING)
    for k in range(GOOD):
        assert math.isnan(watch.look(5.0 + 0.1 * k, 50.0, alone=False)) == (k < GOOD - 1)
    assert watch.use is Use.USED


def test_a_channel_that_repeats_itself_is_stuck_except_at_the_end_of_its_range():
    inside, at_end = Watch(0.5, (0.0, 10.0)), Watch(0.5, (0.0, 10.0))
    for _ in range(STUCK + 1):
        inside.look(3.0, 0.1, alone=True)
        at_end.look(0.0, 0.1, alone=True)
    assert inside.use is Use.STUCK
    assert at_end.use is Use.USED


def test_too_few_members_are_refused():
    n = len(CHANNELS)
    card = Card(12.0, np.zeros(n), np.ones(n), np.ones(n, bool), 0.5, 5e-6, True, True)
    with pytest.raises(ValueError, match="members"):
        Filter(CIRCUIT, card, Settings(members=6), 1)
