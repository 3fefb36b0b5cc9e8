"""What `hydrotwin follow --health` prints: how far each hypothesis has gone, or why nothing is judged yet."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from bridge.cli.tables import print_table
from twin.estimation.health import Finding, Health, Rules, limit, sides_of
from twin.estimation.hypotheses import HYPOTHESES, in_words
from twin.estimation.quantities import LEAKS_OUTSIDE

BY_TWINS = "by twins alone"  # in place of a deviate


class Needed(NamedTuple):
    """What a judge needs of an estimate that follows [s]."""

    rest: float
    commissioning: float
    looks: float

    @property
    def words(self) -> str:
        """For people."""
        parts = f"{self.rest:g} s to come to rest, {self.commissioning:g} s of commissioning, {self.looks:g} s of looks"
        return f"{sum(self):g} s of an estimate that follows are needed ({parts})"


def needed(rules: Rules) -> Needed:
    """By the rules."""
    return Needed(*(looks * rules.look for looks in (rules.resting, rules.commissioning, rules.window)))


def limit_of(health: Health, rules: Rules) -> float:
    """Of the deviates, beyond which it is an alarm."""
    judged = {n: HYPOTHESES[n] for n in health.findings if HYPOTHESES[n].unknown not in LEAKS_OUTSIDE}
    return limit(rules, max(1, sides_of(judged)))


def print_health(health: Health, rules: Rules) -> None:
    """How far each unknown has gone from its baseline, and what is made of it."""
    if not health.findings:
        return
    head = ("fault", f"deviate, limit {limit_of(health, rules):.2f}", "if it were this one alone")
    print_table(head, [*_rows(health)])


def _rows(health: Health) -> Iterator[tuple[str, str, str]]:
    for name, hypothesis in HYPOTHESES.items():
        found = health.findings.get(name)
        if hypothesis.unknown in LEAKS_OUTSIDE:
            yield (
                name,
                BY_TWINS,
                f"{hypothesis.words}, looked for on suspicion" if found is None else _size(name, found),
            )
        elif found is not None:
            yield name, _deviate(found.deviate), _size(name, found)


def _deviate(deviate: float) -> str:
    return "not known" if math.isnan(deviate) else f"{round(deviate, 1) + 0.0:.1f}"  # 0.0 has a sign: -0.0 + 0.0 is 0.0


def _size(name: str, found: Finding) -> str:
    return in_words(name, found.size, found.deviation)
