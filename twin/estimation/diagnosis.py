"""Is a rig ill, and of what? Alarms by how far its unknowns have gone, the name by twins with one fault each.

The judge (twin/estimation/health.py) suspects a fault as seldom as is asked for. Which fault it is is not left to the
unknowns of one estimate, which go over from one to another while a fault is new, and for long where the model of the
rig is not exact: from then on twins of the baseline with one number changed run beside the rig
(twin/estimation/contest.py). It is an alarm once one of them is a hundred times as likely as the baseline and the
baseline leaves more than it did in order or twice what that fault leaves, or once it leaves five times what it did. The
first that is a hundred times as likely as any other, and as none, is named. What is in order the judge learns.
"""

import math
from collections import deque
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.estimation.contest import Contest, Ranking
from twin.estimation.filter import Filter
from twin.estimation.health import Finding, Health, Judge, Knowledge, Rules
from twin.estimation.hypotheses import Verdict
from twin.estimation.shots import Shots
from twin.topology import CHANNELS

Array = NDArray[np.float64]
KEPT = 60  # shots in order that say how large residuals are, the newest
LEFT = 0.05  # of the mean square that the baseline leaves: a fault that leaves less explains it
HEALED = 4  # shots that the baseline must explain before a named fault is gone


class Named(NamedTuple):
    """What a contest has ended with."""

    suspects: tuple[str, ...]  # the likeliest first
    ranking: Ranking


class Diagnosis:
    """Of the rig of one estimate. What is done to the estimate is done here after it."""

    def __init__(self, estimate: Filter, rules: Rules) -> None:
        """Raises ValueError where the rules do not fit one another."""
        self.judge = Judge({name: prior.deviation for name, prior in estimate.priors.items()}, rules)
        self.latest = self.judge.latest
        self._estimate, self._rules = estimate, rules
        self._powers: deque[Array] = deque(maxlen=KEPT)  # by channel, mean squares of residuals in shots
        self._least = np.array([*estimate.settings.model_errors().values()]) ** 2
        self.forget()

    def forget(self) -> None:
        """What runs beside the rig begins anew; its baseline is kept."""
        self._own: Shots | None = None  # the twin of the baseline alone, for ever
        self._contest: Contest | None = None
        self._named: Named | None = None
        self._confirmed = False  # what the judge suspects the twins see, too
        self._rested = -math.inf  # [s], when the last contest ended
        self._recent: deque[float] = deque(maxlen=HEALED)  # J of the baseline
        self._clear()

    def advance(self, reference: float, steps: int) -> None:
        """Move on under a spool reference."""
        for twins in (self._own, self._contest):
            if twins is not None:
                twins.advance(reference, steps)

    def look(self, readings: Mapping[str, float]) -> None:
        """Take a scan."""
        if self._own is not None and (away := self._own.look(readings)) is not None:
            known = ~np.isnan(away[0])
            self._square[known] += away[0, known] ** 2
            self._count += known
        if self._contest is not None:
            self._contest.look(readings)

    def take(self, known: Knowledge) -> Health | None:
        """An estimate, after a correction; what is made of it where it ends a look."""
        health = self.judge.take(known)
        if not known.following:
            self.forget()
        else:
            self._turn(known)
        if health is None:
            return None
        self.latest = self._isolated(health)
        if health.verdict >= Verdict.HEALTHY:
            self.judge.learn(self.latest.verdict is Verdict.HEALTHY)
        return self.latest

    def _turn(self, known: Knowledge) -> None:
        """Shots that are over give way to the next."""
        if self._own is None:
            self._own = Shots(self._estimate, self._estimate.names, self._baseline(known)[None])
            self._own.begin()
        elif self._own.over:
            if self._count.any():
                self._note(self._square / np.maximum(self._count, 1), self._count > 0)
            self._clear()
            self._own.begin(self._baseline(known)[None])
        if self._contest is not None and self._contest.over:
            self._contest.turn()

    def _baseline(self, known: Knowledge) -> Array:
        baseline = self.judge.baseline
        return known.mean if baseline is None else baseline.mean

    def _note(self, power: Array, there: NDArray[np.bool_]) -> None:
        """Of a shot of the baseline."""
        if self.latest.verdict <= Verdict.HEALTHY:
            self._powers.append(np.where(there, power, np.nan))
        self._recent.append(float((power / self._scales() ** 2)[there].mean()))

    def _scales(self) -> Array:
        """Of a residual by channel: with the rig in order, and no less than the errors of the model."""
        own = np.array([[np.nan] * len(CHANNELS), *self._powers])
        median = [np.median(column[~np.isnan(column)]) if not np.isnan(column).all() else 0.0 for column in own.T]
        return np.sqrt(np.maximum(median, self._least))

    def _clear(self) -> None:
        self._square, self._count = np.zeros(len(CHANNELS)), np.zeros(len(CHANNELS), int)

    def _isolated(self, health: Health) -> Health:
        """A verdict, with the name that the twins have found."""
        if health.verdict <= Verdict.COMMISSIONING:
            self._drop()
            return health
        suspected = health.verdict > Verdict.HEALTHY
        if not suspected and (not self._confirmed or self._healed()):
            self._drop()
            return health
        if suspected or self._named is None:
            self._decide(health)
        if not self._confirmed:
            return health._replace(verdict=Verdict.HEALTHY, suspects=(), confidence=math.nan, since=math.nan)
        health = health if suspected else health._replace(since=self.latest.since)
        if self._named is None:
            return health._replace(verdict=Verdict.ONE_OF, suspects=_farthest(health.findings))
        return _with(self._named, health, self._rules)

    def _drop(self) -> None:
        """Nothing is suspected any more."""
        self._contest = self._named = None
        self._confirmed, self._rested = False, -math.inf

    def _decide(self, health: Health) -> None:
        """Begin, go on with or end a contest."""
        contest, rules = self._contest, self._rules
        if contest is None:
            if health.stamp - self._rested >= rules.again:
                assert self.judge.baseline is not None
                self._contest = Contest(self._estimate, self.judge.baseline.mean, self._scales())
            return
        if contest.shots < rules.shots:
            return
        found = contest.ranking()
        matters = found.without > rules.explained or found.without > rules.worth * found.square
        told = found.nothing >= rules.certain and matters
        self._confirmed = self._confirmed or told or found.without > rules.strange
        likely = tuple(name for name, behind in found.behind.items() if behind < rules.certain)
        ended = contest.shots >= rules.most_shots
        if ended and health.verdict is Verdict.FAULT and health.suspects[0] in likely:
            likely = health.suspects  # what the twins leave open the estimate may tell
        if ended or (told and len(likely) == 1):
            self._named = Named(likely, found) if self._confirmed else None
            self._contest, self._rested = None, health.stamp

    def _healed(self) -> bool:
        return len(self._recent) == HEALED and float(np.mean(self._recent)) < self._rules.explained


def _farthest(findings: Mapping[str, Finding]) -> tuple[str, ...]:
    """The two hypotheses whose unknowns have gone farthest."""
    return tuple(sorted(findings, key=lambda name: -abs(np.nan_to_num(findings[name].deviate)))[:2])


def _with(named: Named, health: Health, rules: Rules) -> Health:
    """What is said of a fault with a name, or of those that remain."""
    found = named.ranking
    alone = len(named.suspects) == 1 and found.nothing >= rules.certain
    findings = dict(health.findings)
    # where the estimate has followed, its size is the better
    agreed = _farthest(findings)[0] if health.explained else ""
    for name, (size, deviation) in found.sizes.items():
        if name == agreed == named.suspects[0]:
            continue
        deviate = findings[name].deviate if name in findings else math.nan
        findings[name] = Finding(deviate, size, deviation)
    whole = sum(math.exp(-behind) for behind in found.behind.values()) + math.exp(-found.nothing)
    confidence = math.exp(-found.behind[named.suspects[0]]) / whole
    return Health(
        health.stamp,
        Verdict.FAULT if alone else Verdict.ONE_OF,
        named.suspects,
        confidence,
        health.since,
        findings,
        found.square < max(rules.explained, LEFT * found.without),
    )
