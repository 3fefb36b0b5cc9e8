"""Search for values of a scenario: runs in any number of processes, each once, and the result as a scenario file."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import UsageError
from bridge.runs.run import ready_to_run
from bridge.runs.sweep.point import run_of
from bridge.runs.tune.goal import Goal
from bridge.runs.tune.search import Search, Shares
from bridge.runs.tune.varied import Varied
from bridge.scenario import Scenario, changed
from bridge.scenario.law_file import law_facts
from bridge.scenario.measures import refuse_outside
from bridge.studies.sweep.crew import Ask, chosen, cores
from bridge.studies.sweep.engine import Crew, identity, progress
from bridge.studies.sweep.journal import Journal, Point, Result, key_of

ROUNDED = (2, 3, 4, 5)  # digits that are tried for the result, the fewest first
WORSE = 5e-3  # by how much of itself the objective may grow for them


class Wanted(NamedTuple):
    """A search, as asked for."""

    scenario: Scenario
    varied: list[Varied]
    goal: Goal
    runs: int
    seed: int


class Trial(NamedTuple):
    """Values and what the run with them came to; no values: the scenario as it stands."""

    values: tuple[float, ...]
    result: Result


class Found(NamedTuple):
    """A search that has ended."""

    wanted: Wanted
    start: Trial  # the scenario as it stands
    best: Trial
    trials: list[Trial]  # in the order in which they were asked for
    converged: bool

    @property
    def feasible(self) -> bool:
        """Is there a result?"""
        return self.wanted.goal.feasible(self.best.result)


class Runs:
    """The runs of a search: each different one once, kept on disk while the search goes on."""

    def __init__(self, wanted: Wanted, ask: Ask, journal: Journal, advance: Callable[[], Any]) -> None:
        self.wanted, self._ask, self._journal, self._advance = wanted, ask, journal, advance
        self._known: dict[str, Result] = {}
        self.trials: list[Trial] = []

    def of(self, values: Sequence[tuple[float, ...]]) -> list[Result]:
        """What runs with these values come to."""
        points = {at: _point(self.wanted, at) for at in values}
        new = {at: point for at, point in points.items() if key_of(point) not in self._known}
        missing = [point for point in new.values() if key_of(point) not in self._journal.found]
        for point, result in self._ask(missing) if missing else ():
            self._journal.add(point, result)
        for at, point in new.items():
            self._known[key_of(point)] = self._journal.found[key_of(point)]
            self.trials.append(Trial(at, self._known[key_of(point)]))
            self._advance()
        return [self._known[key_of(points[at])] for at in values]

    def energies(self, shares: list[Shares]) -> list[float]:
        """The same for a search."""
        values = [_values(self.wanted, at) for at in shares]
        return [self.wanted.goal.energy(result) for result in self.of(values)]


def refuse(wanted: Wanted) -> None:
    """Raises UsageError for what cannot be run, before anything runs: one line."""
    refuse_outside(wanted.goal.measures, wanted.scenario)
    ready_to_run(wanted.scenario)
    base = wanted.scenario.model_dump(mode="json")
    for number, one in enumerate(wanted.varied):
        for value in (one.low, one.high):
            change = f"{one.name}={one.text(value)}"
            try:
                changed(base, [change], wanted.scenario.name)
            except UsageError as error:
                if not _possible(wanted, base, number, value):
                    own = str(error).splitlines()[0].removeprefix(f"{wanted.scenario.name}: ")
                    raise UsageError(f"--vary {change}: {own.removeprefix(f'{one.name}: ')}") from None


def _possible(wanted: Wanted, base: dict[str, Any], number: int, value: float) -> bool:
    """Is an end of a range possible with the ends of any other?"""
    ends = [(value,) if index == number else (one.low, one.high) for index, one in enumerate(wanted.varied)]
    for values in product(*ends):
        try:
            changed(base, _point(wanted, values)["changes"], wanted.scenario.name)
        except UsageError:
            continue
        return True
    return False


def _values(wanted: Wanted, shares: Shares) -> tuple[float, ...]:
    return tuple(one.value(share) for one, share in zip(wanted.varied, shares, strict=True))


def _point(wanted: Wanted, values: tuple[float, ...]) -> Point:
    pairs = zip(wanted.varied, values, strict=True) if values else ()
    return {"changes": [f"{one.name}={one.text(value)}" for one, value in pairs]}


def tune(wanted: Wanted, part: Path, crew: Crew) -> Found:
    """Search. `part` keeps what has been found until the search has ended."""
    base, goal = wanted.scenario.model_dump(mode="json"), wanted.goal
    words = [asked.words for asked in goal.measures]
    task = partial(run_of, base=base, which=wanted.scenario.name, measures=words)
    title = f"tune {wanted.scenario.name}"
    about = {"title": title, "scenario": base, "measures": words, **law_facts(wanted.scenario.controller)}
    journal = Journal(part, identity(task, about))
    workers = crew.workers or cores()
    with progress(title, wanted.runs, 0) as advance, chosen(task, wanted.runs, workers, crew.scheduler) as ask:
        runs = Runs(wanted, ask, journal, advance)
        found = _searched(wanted, runs)
    journal.remove()
    return found


def _searched(wanted: Wanted, runs: Runs) -> Found:
    goal = wanted.goal
    start = Trial((), runs.of([()])[0])
    search = Search(runs.energies, wanted.runs - 1 - len(ROUNDED))
    converged = search.run(tuple(one.own_share for one in wanted.varied), wanted.seed)
    best = min(runs.trials[1:], key=lambda trial: goal.energy(trial.result))
    if goal.feasible(best.result):
        best = _rounded(wanted, runs, best)
    return Found(wanted, start, best, runs.trials, converged)


def _rounded(wanted: Wanted, runs: Runs, best: Trial) -> Trial:
    """The best with as few digits as cost nothing: it must keep the bands, and the objective must hardly grow."""
    goal, value = wanted.goal, best.result["values"][0]
    shares = [one.share(v) for one, v in zip(wanted.varied, best.values, strict=True)]
    tried = [tuple(one.value(s, n) for one, s in zip(wanted.varied, shares, strict=True)) for n in ROUNDED]
    for values, result in zip(tried, runs.of(tried), strict=True):
        if goal.feasible(result) and result["values"][0] <= value + WORSE * abs(value):
            return Trial(values, result)
    return best
