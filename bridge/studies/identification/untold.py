"""Combinations of numbers that the data cannot tell, and what they tell of the same numbers instead.

The columns of the Jacobian J (residuals in deviations of the noise, starts taken out) are scaled by how well each
number is known before, UNTOLD at most. In a direction whose singular value is then below 1 the data do not decide but
what was known before, even where that makes the error of each number small. Of two numbers with such a direction the
data tell one combination: a product of powers where both are fitted by their logarithm.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bridge.studies.identification.data import Array
from bridge.studies.identification.parameters import WIDE, Parameter

UNTOLD = 0.5  # deviation of a place: a factor of 1.6 either way
PART = 0.3  # share of a direction with which a number takes part in it
POOR = 0.25  # deviation of a number, or a combination, above which it counts as not identified
NOTHING = 1e-9  # singular values below this share of the greatest say nothing


class Direction(NamedTuple):
    """A combination of numbers that the data cannot tell."""

    spread: float  # how far the places can go along it before the data see it
    shares: tuple[tuple[str, float], ...]  # of the numbers that take part, the greatest first
    told: str  # what the data tell of them; empty where that is more than one combination, or none
    error: float  # standard error of that
    stated: bool  # something is known before of one of them

    @property
    def words(self) -> str:
        """In one sentence."""
        first, *rest = (name for name, _ in self.shares)
        reach = "hardly" if self.spread > 10.0 else f"only to {self.spread:.0%}"
        way_out = "what was known before (--prior) decides" if self.stated else "fix one of them, or give it a --prior"
        if not rest:
            own = way_out if self.stated else "fix it, or give it a --prior"
            return f"{first}: these data tell it {reach}; {own}"
        if self.told:
            only = f"These data tell only {self.told} (error {100.0 * self.error:.2g} %)"
            return f"{only}, not {first} and {rest[0]}: {way_out}"
        same = [name for name, share in self.shares[1:] if share * self.shares[0][1] > 0.0]
        other = [name for name in rest if name not in same]
        ways = [f"{_listed(same)} grow{'' if len(same) > 1 else 's'} with it"] if same else []
        ways += [f"{_listed(other)} fall{'' if len(other) > 1 else 's'}"] if other else []
        return f"{first}: these data tell it {reach} while {' and '.join(ways)}; {way_out}"


def data_alone(jacobian: Array) -> Array:
    """Covariance of the places by the data alone; huge along what they do not tell."""
    _, single, right = np.linalg.svd(jacobian, full_matrices=False)
    single = np.maximum(single, NOTHING * max(float(single[0]), 1e-300))
    return (right.T / single**2) @ right


def untold(jacobian: Array, parameters: Sequence[Parameter], covariance: Array) -> list[Direction]:
    """Directions in which not the data decide, the worst first; covariance: of the places."""
    scale = np.minimum([one.prior for one in parameters], UNTOLD)
    _, single, right = np.linalg.svd(jacobian * scale, full_matrices=False)
    found = []
    for s, scaled in zip(single[::-1], right[::-1], strict=True):
        if s >= 1.0:
            break
        along = scale * scaled
        reach = float(np.linalg.norm(along) / max(s, NOTHING))
        found.append(_direction(reach, along / np.linalg.norm(along), parameters, covariance))
    return found


def _direction(spread: float, along: Array, parameters: Sequence[Parameter], covariance: Array) -> Direction:
    part = [int(i) for i in np.argsort(-np.abs(along)) if abs(along[i]) >= PART]
    shares = tuple((parameters[i].name, float(along[i])) for i in part)
    stated = any(parameters[i].prior < WIDE for i in part)
    if len(part) != 2:
        return Direction(spread, shares, "", np.inf, stated)
    across = np.zeros(len(along))
    across[part] = along[part[1]], -along[part[0]]
    across /= across[np.argmax(np.abs(across))]
    error = float(np.sqrt(across @ covariance @ across))
    told = _words([(parameters[i], float(across[i])) for i in sorted(part, key=lambda i: -across[i])])
    return Direction(spread, shares, told if error <= POOR else "", error, stated)


def _words(terms: Sequence[tuple[Parameter, float]]) -> str:
    """A product of powers; a sum [SI] where a number is not fitted by its logarithm."""
    if all(one.scale == 0.0 for one, _ in terms):
        (first, _), (second, power) = terms
        sign = "/" if power < 0.0 else "*"
        return f"{first.name}{sign}{second.name}{'' if abs(abs(power) - 1.0) < 0.02 else f'^{abs(power):.2g}'}"
    first, second = (share / (one.scale or one.start) for one, share in terms)
    (one, _), (other, _) = terms
    return f"{one.name} {'-' if second * first < 0.0 else '+'} {abs(second / first):.3g} {other.name}"


def _listed(names: Sequence[str]) -> str:
    return " and ".join(names)
