"""Which single fault explains how the unknowns of an estimate have left their baseline, if any does.

The unknowns z of a healthy rig stay about a baseline, which is what they are while the rig is commissioned, and in the
`learning` after it as long as it is said to be in order: a look counts for the baseline once the `doubt` looks after it
have been in order, too, so that what drifts is seen before it is learned. Each `look` gives the mean of z since the
last one; x is the median of the looks of a `window`, less the baseline. Its covariance is

    S = P + (1 + 1/n) C + H

with P what the estimate says of itself, C the scatter of the n windows that the baseline is of, which holds what no
filter knows of itself (errors of its model that come and go with the motion), and H what a healthy rig may wander
by. A hypothesis says that x = s a + an error of covariance S, along its axis a. With w = W a, W the inverse of S
without what C says off its diagonal (of few windows it cannot be inverted), the most likely size is s = w'x/w'a, and

    u = w'x/sqrt(w'S w)

has variance 1 as long as nothing is wrong. Twice what the hypothesis gains in log likelihood is u^2, the generalised
likelihood ratio (M. Basseville, I. Nikiforov, Detection of Abrupt Changes, 1993, 7.2). Since C is an estimate, u is
distributed like Student's t, of (n - 1)/c^2 degrees of freedom where C makes up the share c of its variance
(F. E. Satterthwaite, Biometrics 2, 1946); it is turned into the normal deviate of the same tail, so that one limit
serves all.

A suspicion needs `persistence` looks in a row above the limit L, a name as many in which it is the likeliest. With m
one-sided hypotheses (one of both signs counts twice) and N looks per hour the expected number of false alarms per hour
is at most N m Q(L), whatever the correlation of looks and of hypotheses (Boole's inequality), with Q the normal tail. L
makes this the number that is asked for. Neighbouring windows share most of their looks, and a run of looks is rarer
than one look, so it is fewer.
"""

import math
from collections import deque
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr, ndtri, ndtri_exp, stdtr

from twin.estimation.hypotheses import EITHER, HYPOTHESES, Hypothesis, Verdict

Array = NDArray[np.float64]
FARTHEST = 1e3  # deviates beyond this are all the same
LEAST_SHARE = 1e-3  # of the scatter in a variance: some million degrees of freedom are those of a normal deviate


class Rules(NamedTuple):
    """How it is judged."""

    alarms_per_hour: float = 0.01  # false ones, at most, of a healthy rig
    look: float = 0.5  # [s]
    window: int = 4  # looks; whole cycles of the motion, for what comes and goes with it
    commissioning: int = 60  # looks; 15 windows
    learning: int = 1200  # looks that the baseline is of, in the end
    doubt: int = 240  # looks
    persistence: int = 3  # looks
    resting: int = 20  # looks after the estimate has begun, or was lost, until it has come to rest
    margin: float = 2.0 * math.log(100.0)  # of twice the log likelihood; a hundred times as likely as the next
    healthy: float = 0.1  # what a healthy rig wanders by, as a share of the deviations of the unknowns at the start
    strange: float = 5.0  # mean square that the baseline leaves, in order 1, which is an alarm without a name
    explained: float = 1.5  # mean square, in order 1, that leaves nothing to be explained
    worth: float = 2.0  # times what a fault leaves, that the baseline leaves, if it leaves no more than in order
    shots: int = 4  # of half a second, before twins may name a fault
    most_shots: int = 16  # after which what is still likely is said
    again: float = 20.0  # [s], after which a fault that lasts is looked at anew
    certain: float = math.log(100.0)  # of the log likelihood that a name is ahead
    known: float = 0.5  # an unknown counts as known once its deviation, if it moves alone, is less than this share of
    # that at the start


class Knowledge(NamedTuple):
    """What an estimate says of its unknowns at an instant."""

    stamp: float  # [s]
    following: bool
    mean: Array  # of z
    covariance: Array
    square: float = 1.0  # mean square of the whitened innovations of the channel that agrees least


class Finding(NamedTuple):
    """Of one hypothesis."""

    deviate: float  # normal, signed: how far the rig has gone its way; NaN: not known
    size: float  # s: ln of the factor, or an offset in SI
    deviation: float  # of the size


class Health(NamedTuple):
    """What is known after a look."""

    stamp: float  # [s]
    verdict: Verdict
    suspects: tuple[str, ...]  # the likely ones, the likeliest first; one of a FAULT
    confidence: float  # share of the first in the likelihood of all, and of none of them; NaN where there is none
    since: float  # [s] from when on the first has been beyond the limit; NaN
    findings: dict[str, Finding]
    explained: bool = False  # the estimate agrees with the readings: sizes are to be believed


def limit(rules: Rules, sides: int) -> float:
    """L, so that looks of a healthy rig go beyond it as often as is asked for, or less often."""
    return float(-ndtri(rules.alarms_per_hour * rules.look / (3600.0 * sides)))


def sides_of(hypotheses: Mapping[str, Hypothesis]) -> int:
    """How many one-sided hypotheses they are."""
    return sum(2 if hypothesis.sign == EITHER else 1 for hypothesis in hypotheses.values())


def deviate_of(t: float, freedom: float) -> float:
    """The normal deviate of the tail of Student's t, with the sign of t."""
    tail = float(stdtr(freedom, -abs(t)))
    if tail > 0.0:
        found = -float(ndtri(tail))
    else:  # beyond what a float holds: as t^-freedom goes to 0
        found = -float(ndtri_exp(max(float(log_ndtr(-FARTHEST)), -freedom * math.log(abs(t)))))
    return math.copysign(min(found, FARTHEST), t)


class Baseline(NamedTuple):
    """What the commissioning has found."""

    mean: Array
    scatter: Array  # (1 + 1/n) C
    windows: float  # n


def baseline_of(looks: Array, window: int) -> Baseline:
    """Of the means of looks, one row each."""
    whole = np.median(np.lib.stride_tricks.sliding_window_view(looks, window, axis=0), axis=-1)
    mean, n = whole.mean(axis=0), len(looks) / window
    away = whole - mean
    return Baseline(mean, (1.0 + 1.0 / n) * (n / (n - 1.0)) * (away.T @ away) / len(whole), n)


class Judge:
    """Of one drive. Give it every estimate; it looks when it is time."""

    def __init__(self, priors: Mapping[str, float], rules: Rules) -> None:
        """priors: by name of the unknowns that are estimated, in their order, the deviation at the start."""
        if rules.commissioning < 3 * rules.window:
            raise ValueError(
                f"a commissioning of {rules.commissioning} looks: at least {3 * rules.window}, three windows"
            )
        self.rules, self.names = rules, tuple(priors)
        self.hypotheses = {name: h for name, h in HYPOTHESES.items() if h.unknown in priors}
        self.limit = limit(rules, max(1, sides_of(self.hypotheses)))
        self._start = np.array([*priors.values()])
        self.latest = Health(math.nan, Verdict.NOT_KNOWN, (), math.nan, math.nan, {})
        self.forget()

    def forget(self) -> None:
        """Commission again."""
        self.baseline: Baseline | None = None
        self._looks: deque[Array] = deque(maxlen=self.rules.window)
        self._learned: list[Array] = []  # looks
        self._doubtful: deque[Array] = deque()  # looks that may yet be learned
        self._covariances: deque[Array] = deque(maxlen=self.rules.window)
        self._alarm, self._against, self._since = False, 0, math.nan
        self._rests = self.rules.resting  # looks that are still waited for
        self._first, self._firsts = "", 0  # the likeliest hypothesis, and in how many looks in a row
        self._begin(math.nan)

    def take(self, known: Knowledge) -> Health | None:
        """An estimate; what is made of it where it ends a look."""
        if not self._begun <= known.stamp:  # the first, or another run
            self._begin(known.stamp)
        self._followed &= known.following
        self._sum += known.mean
        self._spread += known.covariance
        self._count += 1
        self._explained = known.square <= self.rules.explained
        if known.stamp - self._begun < self.rules.look - 1e-9:
            return None
        self.latest = self._look(known.stamp)
        self._begin(known.stamp)
        return self.latest

    def learn(self, in_order: bool) -> None:
        """Was the rig in order in the newest look? One that was counts for the baseline if those after it are, too."""
        if not in_order:
            self._doubtful.clear()
        elif self._looks and self.baseline is not None and len(self._learned) < self.rules.learning:
            self._doubtful.append(self._looks[-1])
            if len(self._doubtful) > self.rules.doubt:
                self._learned.append(self._doubtful.popleft())
                self.baseline = baseline_of(np.array(self._learned), self.rules.window)

    def _begin(self, stamp: float) -> None:
        self._begun, self._followed, self._count, self._explained = stamp, True, 0, False
        self._sum, self._spread = np.zeros(len(self.names)), np.zeros((len(self.names),) * 2)

    def _look(self, stamp: float) -> Health:
        if not self._followed:
            for kept in (self._looks, self._covariances, self._doubtful):  # of before they say nothing of what comes
                kept.clear()
            self._rests = self.rules.resting
            self._alarm, self._against = False, 0
            return Health(stamp, Verdict.NOT_KNOWN, (), math.nan, math.nan, {})
        if self._rests:
            self._rests -= 1
            return Health(stamp, Verdict.NOT_KNOWN, (), math.nan, math.nan, {})
        self._looks.append(self._sum / self._count)
        self._covariances.append(self._spread / self._count)
        if self.baseline is None:
            self._learned.append(self._looks[-1])
            if len(self._learned) == self.rules.commissioning:
                self.baseline = baseline_of(np.array(self._learned), self.rules.window)
                self._looks.clear()
                self._covariances.clear()
            return Health(stamp, Verdict.COMMISSIONING, (), math.nan, math.nan, {})
        if len(self._looks) < self.rules.window:
            return Health(stamp, Verdict.NOT_KNOWN, (), math.nan, math.nan, {})
        return self._judged(stamp, self.findings(self.baseline))

    def findings(self, baseline: Baseline) -> dict[str, Finding]:
        """Of all hypotheses, over the window."""
        x = np.median(np.array(self._looks), axis=0) - baseline.mean
        own = np.mean(np.array(self._covariances), axis=0)
        stated = own + np.diag((self.rules.healthy * self._start) ** 2)
        whole = stated + baseline.scatter
        weights = _inverse(stated + np.diag(np.diag(baseline.scatter)), self._start)
        alone = 1.0 / np.sqrt(np.diag(_inverse(own, self._start)))  # deviation of each, the others as they were
        known = alone < self.rules.known * self._start
        found = {}
        for name, hypothesis in self.hypotheses.items():
            place = self.names.index(hypothesis.unknown)
            weight, one = weights[place], float(weights[place, place])
            along, variance = float(weight @ x), float(weight @ whole @ weight)
            share = float(weight @ baseline.scatter @ weight) / variance
            u = deviate_of(along / math.sqrt(variance), (baseline.windows - 1.0) / max(share, LEAST_SHARE) ** 2)
            if hypothesis.sign * u < 0.0:
                u = 0.0
            found[name] = Finding(u if known[place] else math.nan, along / one, math.sqrt(variance) / one)
        return found

    def _judged(self, stamp: float, findings: dict[str, Finding]) -> Health:
        gains = {name: f.deviate**2 for name, f in findings.items() if not math.isnan(f.deviate)}
        if not gains:
            return Health(stamp, Verdict.NOT_KNOWN, (), math.nan, math.nan, findings)
        order = sorted(gains, key=gains.__getitem__, reverse=True)
        first = gains[order[0]]
        self._first, self._firsts = order[0], self._firsts + 1 if order[0] == self._first else 1
        if not self._lasting(first > self.limit**2, stamp):
            return Health(stamp, Verdict.HEALTHY, (), math.nan, math.nan, findings, self._explained)
        likely = tuple(name for name in order if first - gains[name] < self.rules.margin)
        weights = [math.exp(0.5 * (gain - first)) for gain in gains.values()]
        confidence = 1.0 / (sum(weights) + math.exp(-0.5 * first))
        verdict = Verdict.FAULT if len(likely) == 1 and self._firsts >= self.rules.persistence else Verdict.ONE_OF
        if verdict is Verdict.ONE_OF and len(likely) == 1:
            likely = tuple(order[:2])
        return Health(stamp, verdict, likely, confidence, self._since, findings, self._explained)

    def _lasting(self, beyond: bool, stamp: float) -> bool:
        """Is there an alarm? It ends as it begins, after `persistence` looks in a row."""
        self._against = self._against + 1 if beyond != self._alarm else 0
        if beyond and not self._alarm and self._against == 1:
            self._since = stamp
        if self._against == self.rules.persistence:
            self._alarm, self._against = beyond, 0
        return self._alarm


def _inverse(covariance: Array, unit: Array) -> Array:
    """Of a covariance whose rows have other units, [unit] each."""
    scale = np.outer(unit, unit)
    return np.linalg.inv(covariance / scale) / scale
