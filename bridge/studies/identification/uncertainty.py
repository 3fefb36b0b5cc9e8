"""What a fit does not know: standard errors, correlations, and the combinations that the data cannot tell.

With the Jacobian J of the residuals in deviations of the noise, starts taken out, the covariance of the places is
(J'J + P)^-1, P of what is known before, where what is left is white; otherwise that of `discrepancy`. Where a rod
sticks the residual is rough, and a fit may end although the slopes ask for a further step: this step counts as an
error, too. A number is identified where the data alone tell it, without what was known before.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bridge.studies.identification.data import Array
from bridge.studies.identification.discrepancy import scattered
from bridge.studies.identification.fit import Fitted
from bridge.studies.identification.parameters import Parameter
from bridge.studies.identification.taming import tamed, taming
from bridge.studies.identification.untold import POOR, Direction, data_alone, untold
from bridge.studies.identification.whiteness import Whiteness, whiteness

STRONG = 0.9  # correlation that is told
CERTAIN = 1.959964  # deviations to either side: 95 %


class Estimate(NamedTuple):
    """One number that was fitted."""

    parameter: Parameter
    value: float  # SI
    place: float
    spread: float  # standard error of the place: of a logarithm, or in scales
    alone: float  # the same by the data alone, without what was known before
    at_limit: bool

    @property
    def identified(self) -> bool:
        """Do the data tell it?"""
        return self.alone <= POOR

    @property
    def verdict(self) -> str:
        """Why it is not identified; empty where it is."""
        if self.identified:
            return ""
        return "not identified: its prior decides" if self.spread <= POOR else "not identified"

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
    parameters = found.task.parameters
    plain = _inverse(found.jacobian, parameters)
    covariance = scattered(found, plain) if robust else plain + refused(found, plain)
    spread = np.sqrt(np.diag(covariance))
    alone = np.sqrt(np.diag(data_alone(found.jacobian))) * spread / np.sqrt(np.diag(plain))
    errors = zip(parameters, found.values, found.places.tolist(), spread.tolist(), alone.tolist(), strict=True)
    estimates = [Estimate(one, value, u, own, data, _at_limit(one, u)) for one, value, u, own, data in errors]
    correlation = covariance / np.outer(spread, spread)
    unseen = untold(found.jacobian, parameters, covariance)
    return Uncertainty(estimates, covariance, correlation, unseen, white, robust)


def refused(found: Fitted, plain: Array) -> Array:
    """Square of the step that the slopes still ask for where the fit has ended; plain: (J'J + P)^-1."""
    pull = np.concatenate([tamed(at.residual, True) * taming(at.residual, True) for at in found.shots])
    before = np.array([one.prior for one in found.task.parameters])
    step = plain @ (found.jacobian.T @ pull + found.places / before**2)
    return np.outer(step, step)


def _at_limit(parameter: Parameter, place: float) -> bool:
    low, high = parameter.bounds
    return bool(place - low < 1e-3 or high - place < 1e-3)


def _inverse(jacobian: Array, parameters: Sequence[Parameter]) -> Array:
    """(J'J + P)^-1, by the singular values: numbers that nothing is known of stay as wide as before."""
    known = np.diag([1.0 / one.prior for one in parameters])
    _, single, right = np.linalg.svd(np.vstack([jacobian, known]), full_matrices=False)
    return (right.T / single**2) @ right
