"""From an alarm to a name and back, with shots and contests that say what is wanted: the order of what is said."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from twin.estimation import diagnosis
from twin.estimation.contest import Ranking
from twin.estimation.diagnosis import Diagnosis
from twin.estimation.health import Health, Knowledge, Rules
from twin.estimation.hypotheses import Verdict
from twin.estimation.unknowns import Prior
from twin.topology import CHANNELS

PRIORS = {"leakage": Prior(0.5, 0.0), "friction": Prior(0.1, 0.0)}
RULES = Rules(look=0.5, window=1, commissioning=12, persistence=2, healthy=0.0, resting=0)
SURE = math.log(1e6)
CLEAR = Ranking(
    {"friction": 0.0, "leak_across": SURE, "leak_outside_lower": 9.0}, SURE, {"friction": (0.4, 0.1)}, 0.5, 9.0, 4
)
OPEN = Ranking({"leak_outside_lower": 0.0, "leak_across": 1.0, "friction": SURE}, SURE, {}, 0.5, 9.0, 16)
UNTOLD = Ranking({"friction": 0.0, "leak_across": SURE}, 1.0, {}, 5.0, 9.0, 16)  # no fault is likelier than none


class Twin:
    """The baseline's, in shots that are over at each estimate."""

    residual = 0.0  # of each channel, in errors of the model
    over = True

    def __init__(self, *_: Any) -> None:
        pass

    def begin(self, _: Any = None) -> None:
        pass

    def look(self, _: Any) -> np.ndarray:
        return np.full((1, len(CHANNELS)), Twin.residual)


class Contest:
    """One that has its shots at once."""

    ranked = CLEAR
    over = False

    def __init__(self, *_: Any) -> None:
        self.shots = Contest.ranked.shots

    def ranking(self) -> Ranking:
        return Contest.ranked

    def look(self, _: Any) -> None:
        pass


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch):
    """What is said after so many looks at a leak of a size, by twins whose residuals are so large."""
    monkeypatch.setattr(diagnosis, "Shots", Twin)
    monkeypatch.setattr(diagnosis, "Contest", Contest)
    errors = SimpleNamespace(model_errors=lambda: dict.fromkeys(CHANNELS, 1.0))
    estimate: Any = SimpleNamespace(priors=PRIORS, names=tuple(PRIORS), settings=errors)
    found, rng, clock = Diagnosis(estimate, RULES), np.random.default_rng(1), [0.0]

    def looks(count: int, leak: float, residual: float, following: bool = True) -> list[Health]:
        Twin.residual, told = residual, []
        while len(told) < count:
            z = np.array([leak, 0.0]) + 0.01 * rng.normal(size=2)
            found.look({})
            health = found.take(Knowledge(clock[0], following, z, 1e-6 * np.eye(2)))
            clock[0] += 0.5
            told += [health] if health is not None else []
        return told

    looks(14, 0.0, 0.5)
    assert found.latest.verdict is Verdict.HEALTHY
    return looks


def verdicts(said: list[Health]) -> list[Verdict]:
    return [health.verdict for health in said]


def test_a_name_is_the_twins_and_holds_until_they_and_the_estimate_are_as_before(said):
    Contest.ranked = CLEAR
    named = said(6, 2.0, 9.0)
    assert named[-1].verdict is Verdict.FAULT
    assert named[-1].suspects == ("friction",)  # though it is the leakage that has gone
    assert named[-1].confidence > 0.999
    assert named[-1].explained
    assert named[-1].findings["friction"].size == 0.4
    assert set(verdicts(said(6, 0.0, 9.0))) == {Verdict.FAULT}
    assert verdicts(said(6, 0.0, 0.5))[-1] is Verdict.HEALTHY


def test_what_the_twins_leave_open_the_estimate_tells(said):
    Contest.ranked = OPEN
    last = said(8, 2.0, 9.0)[-1]
    assert last.verdict is Verdict.FAULT
    assert last.suspects == ("leak_across",)
    assert last.confidence == pytest.approx(math.exp(-1.0) / (1.0 + math.exp(-1.0)), rel=1e-3)


def test_the_size_is_the_estimates_where_it_agrees(said):
    """Its leakage has gone by 2, and twins of a leak say 1.5: as long as it does not, it is theirs."""
    leak = CLEAR._replace(behind={"leak_across": 0.0, "friction": SURE}, sizes={"leak_across": (1.5, 0.1)})
    Contest.ranked = leak
    assert said(6, 2.0, 9.0)[-1].findings["leak_across"].size == pytest.approx(2.0, abs=0.05)
    Contest.ranked = CLEAR
    assert said(60, 2.0, 9.0)[-1].findings["friction"].size == 0.4


def test_what_the_estimate_alone_suspects_is_no_alarm(said):
    """The baseline explains what is read as it did, and what is likelier hardly better."""
    for nothing in (1.0, SURE):
        Contest.ranked = CLEAR._replace(nothing=nothing, square=0.4, without=0.6, shots=16)
        assert set(verdicts(said(10, 2.0, 0.6))) == {Verdict.HEALTHY}


def test_what_a_fault_explains_far_better_is_one_however_small(said):
    """A drift that has just begun: residuals are as in order, and a third of that with it."""
    Contest.ranked = CLEAR._replace(square=0.2, without=0.6)
    assert verdicts(said(6, 2.0, 0.6))[-1] is Verdict.FAULT


def test_an_alarm_has_no_name_before_it_is_clear(said):
    Contest.ranked = OPEN._replace(shots=8)
    found = said(8, 2.0, 9.0)
    assert found[-1].verdict is Verdict.ONE_OF
    assert found[-1].suspects == ("leak_across", "friction")  # as far as the estimate has it


def test_an_alarm_goes_on_until_the_twins_are_as_before_whatever_the_estimate_suspects(said):
    """It has a name once they are clear."""
    Contest.ranked = OPEN._replace(shots=8)
    assert verdicts(said(8, 2.0, 9.0))[-1] is Verdict.ONE_OF
    assert set(verdicts(said(6, 0.0, 9.0))) == {Verdict.ONE_OF}
    Contest.ranked = CLEAR
    assert verdicts(said(50, 0.0, 9.0))[-1] is Verdict.FAULT
    assert verdicts(said(6, 0.0, 0.5))[-1] is Verdict.HEALTHY


def test_no_fault_is_named_that_is_no_likelier_than_none(said):
    Contest.ranked = UNTOLD
    last = said(8, 2.0, 9.0)[-1]
    assert last.verdict is Verdict.ONE_OF
    assert last.suspects == ("friction",)
    assert not last.explained


def test_an_estimate_that_is_lost_leaves_no_name(said):
    Contest.ranked = CLEAR
    assert verdicts(said(6, 2.0, 9.0))[-1] is Verdict.FAULT
    assert verdicts(said(1, 2.0, 9.0, following=False)) == [Verdict.NOT_KNOWN]
    assert verdicts(said(2, 0.0, 0.5)) == [Verdict.HEALTHY] * 2
