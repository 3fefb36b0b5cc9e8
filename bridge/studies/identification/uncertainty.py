"""What a fit does not know: standard errors, correlations, and the combinations that the data cannot tell.

With the Jacobian J of the residuals in deviations of the noise, starts taken out, the covariance of the places is
(J'J + P)^-1, P of what is known before. Where residuals are not white, because the twin is not the rig or because
rounding is not noise, neighbours count less than they seem to: then it is C (sum g g') C, with g the sum of J'r over
blocks of half a second (a sandwich, H. White, Econometrica 50 (1982) 1; blocks keep what hangs together).

The singular values of J say how far the places can go along each of its directions before the data see it. A direction
in which that is more than UNTOLD cannot be told; the numbers that take part in it are named.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bridge.studies.identification.data import Array
from bridge.studies.identification.fit import Fitted
from bridge.studies.identification.parameters import Parameter
from bridge.studies.identification.whiteness import Whiteness, whiteness

UNTOLD = 0.5  # deviation of a place: a factor of 1.6 either way
POOR = 0.25  # deviation of a number above which it counts as not identified
PART = 0.3  # share of a direction with which a number takes part in it
BLOCK = 0.5  # [s]
STRONG = 0.9  # correlation that is told
CERTAIN = 1.959964  # deviations to either side: 95 %


class Estimate(NamedTuple):
    """One number that was fitted."""

    parameter: Parameter
    value: float  # SI
    place: float
    spread: float  # standard error of the place: of a logarithm, or in scales
    identified: bool
    at_limit: bool

    @property
    def interval(self) -> tuple[float, float]:
        """95 % [SI], within its limits."""
        ends = (self.place - CERTAIN * self.spread, self.place + CERTAIN * self.spread)
        one = self.parameter
        low, high = (max(min(end, 700.0), -700.0) for end in ends)
        return max(one.value(low), one.low), min(one.value(high), one.high)

    @property
    def error(self) -> float:
        """Standard error [SI]."""
        return self.parameter.deviation(self.value, self.spread)


class Direction(NamedTuple):
    """A combination of numbers that the data cannot tell."""

    spread: float  # how far the places can go along it
    shares: tuple[tuple[str, float], ...]  # of the numbers that take part

    @property
    def words(self) -> str:
        """In one sentence."""
        first, *rest = (name for name, _ in self.shares)
        reach = "hardly at all" if self.spread > 10.0 else f"only within a deviation of {self.spread:.0%}"
        if not rest:
            return f"{first} is told {reach} by these data"
        same = [name for name, share in self.shares[1:] if share * self.shares[0][1] > 0.0]
        other = [name for name in rest if name not in same]
        ways = [f"{' and '.join(same)} grow with it"] if same else []
        ways += [f"{' and '.join(other)} fall"] if other else []
        return f"{first} is told {reach} by these data while {' and '.join(ways)}: fix one of them"


class Uncertainty(NamedTuple):
    """What a fit knows."""

    estimates: list[Estimate]
    covariance: Array  # of the places
    correlation: Array
    untold: list[Direction]
    whiteness: list[Whiteness]
    robust: bool  # the covariance counts residuals that are not white

    @property
    def strong(self) -> list[tuple[str, str, float]]:
        """Pairs of identified numbers that hang together."""
        told = [i for i, one in enumerate(self.estimates) if one.identified]
        names = [one.parameter.name for one in self.estimates]
        pairs = [(i, j, float(self.correlation[i, j])) for i in told for j in told if i < j]
        return [(names[i], names[j], r) for i, j, r in pairs if abs(r) >= STRONG]


def uncertainty(found: Fitted) -> Uncertainty:
    """Of a fit."""
    white = whiteness(found)
    robust = not all(one.passed for one in white)
    plain = _inverse(found.jacobian, found.task.parameters)
    covariance = _sandwich(found, plain) if robust else plain
    spread = np.sqrt(np.diag(covariance))
    estimates = [
        Estimate(one, value, place, own, own <= POOR, _at_limit(one, place))
        for one, value, place, own in zip(
            found.task.parameters, found.values, found.places.tolist(), spread.tolist(), strict=True
        )
    ]
    correlation = covariance / np.outer(spread, spread)
    return Uncertainty(estimates, covariance, correlation, untold(found), white, robust)


def _at_limit(parameter: Parameter, place: float) -> bool:
    low, high = parameter.bounds
    return bool(place - low < 1e-3 or high - place < 1e-3)


def _inverse(jacobian: Array, parameters: Sequence[Parameter]) -> Array:
    """(J'J + P)^-1, by the singular values: numbers that nothing is known of stay as wide as before."""
    known = np.diag([1.0 / one.prior for one in parameters])
    _, single, right = np.linalg.svd(np.vstack([jacobian, known]), full_matrices=False)
    return (right.T / single**2) @ right


def _sandwich(found: Fitted, plain: Array) -> Array:
    """Not narrower than the plain one in any number."""
    scores, row = [], 0
    for shot, at in zip(found.task.shots, found.shots, strict=True):
        record = found.task.records[shot.record]
        signals = len(record.signals)
        rows = slice(row, row + len(at.residual))
        by_sample = (found.jacobian[rows] * at.residual[:, None]).reshape(signals, -1, len(plain)).sum(axis=0)
        length = max(1, round(BLOCK / record.period))
        starts = np.arange(0, len(by_sample), length)
        scores.append(np.add.reduceat(by_sample, starts, axis=0))
        row = rows.stop
    g = np.vstack(scores)
    known = np.diag([1.0 / one.prior**2 for one in found.task.parameters])
    robust = plain @ (g.T @ g + known) @ plain
    wider = np.sqrt(np.maximum(np.diag(robust), np.diag(plain)) / np.diag(robust))
    return robust * np.outer(wider, wider)


def untold(found: Fitted) -> list[Direction]:
    """Directions in which the data leave the places alone, the worst first."""
    _, single, right = np.linalg.svd(found.jacobian, full_matrices=False)
    directions = []
    for s, along in zip(single[::-1], right[::-1], strict=True):
        spread = 1.0 / s if s > 0.0 else np.inf
        if spread <= UNTOLD:
            break
        order = np.argsort(-np.abs(along))
        shares = [(found.task.parameters[i].name, float(along[i])) for i in order if abs(along[i]) >= PART]
        directions.append(Direction(float(spread), tuple(shares)))
    return directions
