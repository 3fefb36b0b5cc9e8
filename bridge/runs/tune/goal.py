"""What a search is after: the smallest value of a measure, within bands.

Rules of feasibility (Deb 2000): a run that keeps all bands is better than one that does not; of two that keep them the
smaller value is better, of two that do not the smaller sum of violations.
"""

import math
import re
from typing import NamedTuple

from bridge.errors import UsageError
from bridge.scenario.bands import parse_band, units_of
from bridge.scenario.measures import Measure, measure
from bridge.scenario.units import shown
from bridge.studies.sweep.journal import Result
from controller.bands import RELATIONS, Band

MOST = 1e3  # violation that counts, and that of a number which a run does not have
INFEASIBLE = 1e30  # beyond any value of a measure
FAILED = 1e6  # times that, of a run that failed


class Limit(NamedTuple):
    """A band that a result must keep."""

    text: str
    measure: Measure
    relation: str
    limit: float  # SI

    def kept(self, value: float | None) -> bool:
        """Does a value keep it?"""
        return value is not None and RELATIONS[self.relation](value, self.limit)

    def violation(self, value: float | None) -> float:
        """By how much a value does not, as a share of the limit; of a limit 0 in the unit that people read."""
        if self.kept(value):
            return 0.0
        if value is None:
            return MOST
        return min(abs(value - self.limit) / (abs(self.limit) or 1.0 / self.measure.factor), MOST)


class Goal(NamedTuple):
    """The measure to make small, and the bands."""

    objective: Measure
    limits: list[Limit]

    @property
    def measures(self) -> list[Measure]:
        """All that a run is asked for, the objective first."""
        return [self.objective, *(limit.measure for limit in self.limits)]

    def violations(self, result: Result) -> list[float]:
        """Of each limit."""
        return [limit.violation(v) for limit, v in zip(self.limits, result["values"][1:], strict=True)]

    def feasible(self, result: Result) -> bool:
        """Did the run go well, with a value, within all bands?"""
        kept = [limit.kept(v) for limit, v in zip(self.limits, result["values"][1:], strict=True)]
        return not result["reason"] and result["values"][0] is not None and all(kept)

    def energy(self, result: Result) -> float:
        """One number that orders runs by the rules of feasibility."""
        if result["reason"]:
            return INFEASIBLE * FAILED
        if self.feasible(result):
            return result["values"][0]
        missing = MOST if result["values"][0] is None else 0.0
        return INFEASIBLE * (1.0 + missing + math.fsum(self.violations(result)))


def goal_of(minimise: str, subject_to: list[str]) -> Goal:
    """The goal in words. Raises UsageError naming the nearest."""
    return Goal(measure(minimise), [_limit(text) for text in subject_to])


def _limit(text: str) -> Limit:
    try:
        return limit_of(text)
    except ValueError as error:
        raise UsageError(f"--subject-to {str(error).removeprefix('expect ')}") from None


def limit_of(text: str) -> Limit:
    """The band that a text states, and the measure that it limits. Raises ValueError naming the nearest."""
    band = parse_band(text)
    words = re.split("<=|>=", text)[0].strip()
    if isinstance(band, Band) and ":" in words:  # "limit cycle: none"
        words = band.metric.replace("_", " ")
    return Limit(text, Measure(words, band, *units_of(band)), band.relation, band.limit)


def with_unit(asked: Measure, value: float | None) -> str:
    """A value as people read it."""
    if value is None:
        return "-"
    factor = shown(asked.unit, asked.shown_unit)[0] if asked.shown_unit != "travels" else 1.0
    return f"{value * factor:.4g} {asked.shown_unit}".rstrip()
