"""Judging health by closed forms: the limit, the rate of false alarms, and which hypothesis is named."""

import math

import numpy as np
import pytest
from scipy.stats import norm, t

from twin.estimation.health import Health, Judge, Knowledge, Rules, Verdict, baseline_of, deviate_of, limit, sides_of
from twin.estimation.hypotheses import HYPOTHESES
from twin.estimation.quantities import UNKNOWNS

NAMES = ("leakage", "friction", "valve_gain")
PRIORS = {"leakage": 0.5, "friction": 0.1, "valve_gain": 0.1}
EXACT = Rules(look=1.0, window=1, persistence=1, healthy=0.0, resting=0)
SURE = 1e-12 * np.eye(3)
STILL = np.full(3, 1e-5)  # deviations of looks that all but repeat themselves


def judge(rules: Rules, rng: np.random.Generator, covariance: np.ndarray, deviations: np.ndarray) -> Judge:
    """One that has been commissioned on white looks."""
    found = Judge(PRIORS, rules)
    for k in range(rules.resting + rules.commissioning + 1):
        look(found, float(k), deviations * rng.normal(size=3), covariance)
    assert found.baseline is not None
    return found


def look(judge: Judge, stamp: float, mean: np.ndarray, covariance: np.ndarray, following: bool = True) -> Health | None:
    return judge.take(Knowledge(stamp, following, mean, covariance))


def test_the_limit_is_the_tail_that_the_rate_leaves_to_a_look():
    """0.01 per hour, 3600 looks of 5 one-sided hypotheses: a tail of 0.01/18000."""
    assert norm.sf(limit(Rules(alarms_per_hour=0.01, look=1.0), 5)) == pytest.approx(0.01 / 18000.0, rel=1e-9)
    named = {name: HYPOTHESES[name] for name in ("leak_across", "friction", "valve_gain")}
    assert sides_of(named) == 5


@pytest.mark.parametrize(("value", "freedom"), [(2.0, 3.0), (-4.5, 9.0), (8.0, 40.0)])
def test_a_deviate_has_the_tail_of_students_t(value: float, freedom: float):
    assert norm.sf(abs(deviate_of(value, freedom))) == pytest.approx(t.sf(abs(value), freedom), rel=1e-9)
    assert math.copysign(1.0, deviate_of(value, freedom)) == math.copysign(1.0, value)


def test_deviates_of_tails_beyond_a_float_go_on_growing():
    found = [deviate_of(value, 2000.0) for value in (30.0, 60.0, 120.0)]
    assert found == sorted(found)
    assert found[0] > 25.0


@pytest.mark.parametrize("commissioning", [12, 150])
def test_false_alarms_come_as_often_as_is_asked_for(commissioning: int):
    """Independent unknowns and looks, for which Boole's bound is all but reached: within 4 deviations of a count.

    After 12 looks alone the scatter is known so badly that a normal limit would be passed three times as often.
    """
    rng, count, looks = np.random.default_rng(1), 0, 0
    rules, deviations = EXACT._replace(commissioning=commissioning, alarms_per_hour=200.0), np.array([0.2, 0.01, 0.03])
    for _ in range(1800 // commissioning):
        found = judge(rules, rng, SURE, deviations)
        for k in range(25):
            health = look(found, commissioning + 1.0 + k, deviations * rng.normal(size=3), SURE)
            assert health is not None
            count, looks = count + any(abs(f.deviate) > found.limit for f in health.findings.values()), looks + 1
    expected = 200.0 / 3600.0 * looks
    assert abs(count - expected) < 4.0 * math.sqrt(expected)


def test_looks_that_hang_together_alarm_less_often():
    """Windows of four looks that forget within ten: fewer alarms than asked for, and not none."""
    rng, rules = np.random.default_rng(2), EXACT._replace(alarms_per_hour=300.0, commissioning=400, window=4)
    found, z, alarms, was = Judge(PRIORS, rules), np.zeros(3), 0, Verdict.COMMISSIONING
    for k in range(4000):
        z = 0.9 * z + math.sqrt(1.0 - 0.81) * rng.normal(size=3) * 0.02
        health = look(found, float(k), z, SURE)
        if health is not None:
            alarms, was = alarms + (health.verdict > Verdict.HEALTHY >= was), health.verdict
    hours = (4000 - 400) / 3600.0
    assert 0 < alarms < 300.0 * hours


def test_the_size_and_what_it_gains_are_those_of_the_likelihood_ratio():
    rng, covariance = np.random.default_rng(3), np.array([[4.0, 1.2, 0.5], [1.2, 1.0, -0.2], [0.5, -0.2, 0.5]]) * 1e-4
    found = judge(EXACT._replace(commissioning=60, known=10.0), rng, covariance, STILL)
    x = np.array([0.04, 0.03, -0.01])
    health = look(found, 61.0, x, covariance)
    assert health is not None
    assert found.baseline is not None
    away, inverse = x - found.baseline.mean, np.linalg.inv(covariance)
    for place, name in enumerate(("leak_across", "friction", "valve_gain")):
        size = inverse[place] @ away / inverse[place, place]
        left = away - size * np.eye(3)[place]
        gain = away @ inverse @ away - left @ inverse @ left
        assert health.findings[name].size == pytest.approx(size, rel=1e-4)  # the scatter is so much less
        if health.findings[name].deviate:
            assert health.findings[name].deviate ** 2 == pytest.approx(gain, rel=1e-3)  # t of 1e5 degrees of freedom


def test_what_moves_as_its_errors_do_is_no_sign_of_either():
    """Leak and valve gain with errors of 0.05 and 0.01, correlated by 0.95: four deviations of one alone name it."""
    rng = np.random.default_rng(4)
    covariance = np.array([[25.0, 0.0, 4.75], [0.0, 1.0, 0.0], [4.75, 0.0, 1.0]]) * 1e-4
    rules = EXACT._replace(commissioning=60)
    alone, both = (judge(rules, rng, covariance, STILL) for _ in range(2))
    one = look(alone, 61.0, np.array([0.2, 0.0, 0.0]), covariance)
    two = look(both, 61.0, np.array([0.2, 0.0, 0.04]), covariance)
    assert one is not None
    assert two is not None
    assert one.verdict is Verdict.FAULT
    assert one.suspects == ("leak_across",)
    assert one.confidence > 0.99
    assert two.verdict is Verdict.HEALTHY


def test_two_that_explain_it_alike_are_both_said():
    rng, covariance = np.random.default_rng(5), np.diag([0.05, 0.01, 0.01]) ** 2
    found = judge(EXACT._replace(commissioning=60), rng, covariance, STILL)
    health = look(found, 61.0, np.array([0.0, 0.1, 0.1002]), covariance)
    assert health is not None
    assert health.verdict is Verdict.ONE_OF
    assert health.suspects == ("valve_gain", "friction")
    assert health.confidence == pytest.approx(0.55, abs=0.1)


def test_a_leak_does_not_shrink():
    """What a hypothesis cannot do is no evidence for it."""
    rng, covariance = np.random.default_rng(6), np.diag([0.05, 0.01, 0.01]) ** 2
    found = judge(EXACT._replace(commissioning=60), rng, covariance, STILL)
    health = look(found, 61.0, np.array([-0.6, 0.0, 0.0]), covariance)
    assert health is not None
    assert health.verdict is Verdict.HEALTHY
    assert health.findings["leak_across"].deviate == 0.0


def test_an_alarm_begins_and_ends_after_looks_in_a_row():
    rng, covariance = np.random.default_rng(7), np.diag([0.05, 0.01, 0.01]) ** 2
    found = judge(EXACT._replace(commissioning=60, persistence=3), rng, covariance, STILL)
    gone, verdicts = np.array([0.0, 0.3, 0.0]), []
    for k, x in enumerate([gone, gone, 0 * gone, gone, gone, gone, 0 * gone, 0 * gone, 0 * gone]):
        health = look(found, 61.0 + k, x, covariance)
        assert health is not None
        verdicts.append(health.verdict)
    assert [v is Verdict.FAULT for v in verdicts[:6]] == [False] * 5 + [True]
    assert verdicts[-1] is Verdict.HEALTHY
    assert Verdict.HEALTHY not in verdicts[5:8]


def test_what_is_not_known_is_not_judged():
    """An estimate that is lost, and an unknown that the motion says nothing about."""
    rng, covariance = np.random.default_rng(8), np.diag([0.05, 0.01, 0.01]) ** 2
    found = judge(EXACT._replace(commissioning=60), rng, covariance, STILL)
    wide = np.diag([0.49, 0.01, 0.01]) ** 2
    health = look(found, 61.0, np.array([3.0, 0.0, 0.0]), wide)
    assert health is not None
    assert math.isnan(health.findings["leak_across"].deviate)
    assert health.verdict is Verdict.HEALTHY
    lost = look(found, 62.0, np.array([0.0, 0.9, 0.0]), covariance, following=False)
    assert lost is not None
    assert lost.verdict is Verdict.NOT_KNOWN


def test_an_estimate_that_begins_anew_is_let_come_to_rest():
    """For as many looks as the rules say it is not judged, and then as before."""
    rng, covariance = np.random.default_rng(11), np.diag([0.05, 0.01, 0.01]) ** 2
    found = judge(EXACT._replace(commissioning=60, resting=5), rng, covariance, STILL)
    wild, verdicts = np.array([0.0, 0.9, 0.0]), []
    look(found, 66.0, 0 * wild, covariance, following=False)
    for k in range(8):
        health = look(found, 67.0 + k, wild if k < 5 else 0 * wild, covariance)
        assert health is not None
        verdicts.append(health.verdict)
    assert verdicts == [Verdict.NOT_KNOWN] * 5 + [Verdict.HEALTHY] * 3


def test_an_estimate_that_has_just_begun_is_no_baseline():
    """What it is while it comes to rest is not what the rig is commissioned with."""
    found = Judge(PRIORS, EXACT._replace(commissioning=60, resting=5))
    rng, verdicts = np.random.default_rng(12), []
    for k in range(67):
        health = look(found, float(k), (5.0 if k <= 5 else 0.0) + STILL * rng.normal(size=3), SURE)
        verdicts.append(health and health.verdict)
    assert verdicts == [None] + [Verdict.NOT_KNOWN] * 5 + [Verdict.COMMISSIONING] * 60 + [Verdict.HEALTHY]
    assert found.baseline is not None
    assert found.baseline.mean == pytest.approx(np.zeros(3), abs=1e-4)


def learned(found: Judge, moves: np.ndarray, rng: np.random.Generator) -> list[Verdict]:
    """Verdicts while the leakage moves so, by a judge whose suspicions nothing else bears out."""
    said = []
    for k, moved in enumerate(moves, 1000):
        z = np.array([moved, 0.0, 0.0]) + [0.05, 0.01, 0.01] * rng.normal(size=3)
        health = look(found, float(k), z, SURE)
        if health is not None and health.verdict >= Verdict.HEALTHY:
            found.learn(True)
            said.append(health.verdict)
    return said


def test_a_rig_in_order_is_learned_with_how_it_wanders():
    """A wander of 1.5 within minutes is suspected for ever by a baseline of 12 looks, and not by one that learns."""
    wander = 1.5 * np.sin(np.arange(2000) / 30.0)
    rng, rules = np.random.default_rng(13), EXACT._replace(commissioning=12, doubt=60)
    for learning, least, most in ((12, 200, 2000), (800, 0, 0)):
        found = judge(rules._replace(learning=learning), rng, SURE, np.array([0.05, 0.01, 0.01]))
        late = learned(found, wander, rng)[1000:]
        assert least <= sum(verdict > Verdict.HEALTHY for verdict in late) <= most


def test_what_drifts_is_suspected_before_it_is_learned():
    """By 0.01 in each look: seven deviations of a look when the first of it would count."""
    rng, rules = np.random.default_rng(14), EXACT._replace(commissioning=60, doubt=60)
    found = judge(rules, rng, SURE, np.array([0.05, 0.01, 0.01]))
    assert Verdict.FAULT in learned(found, 0.01 * np.arange(60), rng)


def test_a_baseline_is_what_its_windows_scatter_about():
    looks = np.random.default_rng(9).normal([1.0, 2.0], [0.1, 0.3], (4000, 2))
    found = baseline_of(looks, 1)
    assert found.mean == pytest.approx([1.0, 2.0], abs=0.02)
    assert np.sqrt(np.diag(found.scatter)) == pytest.approx([0.1, 0.3], rel=0.05)


def test_a_commissioning_of_two_windows_is_refused():
    with pytest.raises(ValueError, match="three windows"):
        Judge(PRIORS, Rules(window=4, commissioning=8))


def test_every_hypothesis_moves_something_that_can_be_estimated():
    assert {hypothesis.unknown for hypothesis in HYPOTHESES.values()} <= set(UNKNOWNS)
