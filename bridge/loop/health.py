"""Health beside an estimate: the unknowns of a filter to its judge, and what the judge says as numbers of a message."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bridge.errors import UsageError
from bridge.wire.estimates import DEVIATION
from bridge.wire.health import DEVIATE, PLACES, SIZE
from twin.estimation.contest import Contest
from twin.estimation.diagnosis import Diagnosis
from twin.estimation.filter import Estimate, Filter
from twin.estimation.health import Finding, Health, Knowledge, Rules
from twin.estimation.hypotheses import HYPOTHESES, WATCHED, Verdict, in_words
from twin.estimation.quantities import Standing, Use
from twin.estimation.settings import Settings
from twin.estimation.unknowns import Prior
from twin.topology import CHANNELS

FEWEST = 28  # members, of an estimate with all the unknowns of faults
UNKNOWN = Finding(float("nan"), float("nan"), float("nan"))


def watching(settings: Settings) -> Settings:
    """Settings that let the unknowns of faults go as far as faults take them, and members enough for them.

    Velocity and pressures do not wander by themselves: a fault is a force or a flow that the model does not know, and
    is to be seen in the unknowns.
    """
    given = {name: Prior(*prior) for name, prior in WATCHED.items()}
    members = max(settings.members, FEWEST)
    quiet = settings._replace(velocity_noise=0.0, pressure_noise=0.0)
    return quiet._replace(unknowns=given | dict(settings.unknowns), members=members)


class HealthSide:
    """The judge of one filter."""

    def __init__(self, filter_: Filter, rules: Rules) -> None:
        """Raises UsageError where the rules do not fit one another."""
        self._filter = filter_
        try:
            self._diagnosis = Diagnosis(filter_, rules)
        except ValueError as error:
            raise UsageError(f"health: {error}") from None
        self.told: list[str] = []  # each verdict that is another than the one before, in words

    @property
    def latest(self) -> Health:
        """After the newest look."""
        return self._diagnosis.latest

    @property
    def limit(self) -> float:
        """Of a normal deviate, beyond which it is an alarm."""
        return self._diagnosis.judge.limit

    def forget(self) -> None:
        """The estimate begins anew."""
        self._diagnosis.forget()

    def warm_up(self) -> None:
        """What an alarm will need, beside a filter that has begun."""
        Contest(self._filter, self._filter.z.mean(axis=0), np.ones(len(CHANNELS))).advance(0.0, 1)

    def advance(self, reference: float, steps: int) -> None:
        """What the filter was told."""
        self._diagnosis.advance(reference, steps)

    def look(self, readings: Mapping[str, float]) -> None:
        """What the filter has looked at."""
        self._diagnosis.look(readings)

    def take(self, estimate: Estimate) -> dict[str, Any] | None:
        """After a correction; the numbers of a message where it ends a look."""
        z, following = self._filter.z, estimate.standing == Standing.FOLLOWING
        before = self.latest
        squares = [found.verdict.nis for found in estimate.innovations.values() if found.use is Use.USED]
        worst = max((square for square in squares if not math.isnan(square)), default=math.inf)
        covariance = np.atleast_2d(np.cov(z.T))
        health = self._diagnosis.take(Knowledge(estimate.stamp, following, z.mean(axis=0), covariance, worst))
        if health is None:
            return None
        if (health.verdict, health.suspects) != (before.verdict, before.suspects):
            self.told.append(words_of(health))
        return {"limit": self.limit, **fields(health)}


def words_of(health: Health) -> str:
    """One line for people."""
    verdict = health.verdict.name.lower().replace("_", " ")
    said = [in_words(name, health.findings[name].size, health.findings[name].deviation) for name in health.suspects]
    if health.verdict is Verdict.FAULT:
        doubt = "" if health.explained else "; it does not explain all that is read: its size is rough"
        verdict = f"fault, beyond the limit since t = {health.since:g} s, confidence {health.confidence:.4f}{doubt}"
    return f"t = {health.stamp:g} s: {verdict}" + (f": {'; or '.join(said)}" if said else "")


def plain(health: Health) -> dict[str, Any]:
    """For JSON; None for what is not known."""
    numbers = {name: _known(found._asdict()) for name, found in health.findings.items()}
    own = {"time": health.stamp, "confidence": health.confidence, "since": health.since}
    verdict = health.verdict.name.lower()
    told = {"verdict": verdict, "suspects": list(health.suspects), "explained": health.explained}
    return {**told, **_known(own), "findings": numbers}


def _known(numbers: dict[str, float]) -> dict[str, float | None]:
    return {name: None if math.isnan(number) else number for name, number in numbers.items()}


def fields(health: Health) -> dict[str, Any]:
    """Of a message, but for its head."""
    suspects = sum(1 << PLACES.index(name) for name in health.suspects)
    first = PLACES.index(health.suspects[0]) if health.suspects else -1
    told: dict[str, Any] = {"verdict": int(health.verdict), "suspects": suspects, "first": first}
    told |= {"confidence": health.confidence, "since": health.since}
    told |= {"explained": int(health.explained)}
    for name in HYPOTHESES:
        found = health.findings.get(name, UNKNOWN)
        told |= {name + DEVIATE: found.deviate, name + SIZE: found.size, name + SIZE + DEVIATION: found.deviation}
    return told
