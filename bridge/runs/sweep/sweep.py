"""A scenario run at every combination of some of its values, and what each run comes to."""

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import UsageError, writing
from bridge.runs.check import NOTHING_EXPECTED, refuse_windows
from bridge.runs.run import ready_to_run
from bridge.runs.sweep.axes import Axis, changes_of, combinations
from bridge.runs.sweep.point import run_of
from bridge.scenario import Scenario, changed
from bridge.scenario.law_file import law_facts
from bridge.scenario.measures import Measure, refuse_outside
from bridge.studies.sweep.engine import HERE, Crew
from bridge.studies.sweep.engine import sweep as swept

MOST_TRIED = 200  # combinations, until a value is called impossible
MOST_BUILT = 100  # values up to which the rig of each is built before anything runs
KEPT_NAME = "{:05d}.mcap"


class Wanted(NamedTuple):
    """A sweep, as asked for."""

    scenario: Scenario
    axes: list[Axis]
    measures: list[Measure]
    judge: bool = False  # the scenario's own bands as well
    keep: bool = False  # the recordings


class Row(NamedTuple):
    """One run."""

    places: tuple[int, ...]  # on the axes
    values: list[float | None]  # SI; None where the run has no such number
    reason: str  # why a run has none at all
    failed: list[str]  # bands of the scenario


class Found(NamedTuple):
    """A sweep and its runs."""

    wanted: Wanted
    rows: list[Row]

    def best(self, column: int) -> int | None:
        """The row with the smallest value of a measure, the first of equal ones; None without any."""
        known = [(row.values[column], index) for index, row in enumerate(self.rows) if row.values[column] is not None]
        return min(known)[1] if known else None

    @property
    def ran(self) -> int:
        """How many runs went well."""
        return sum(not row.reason for row in self.rows)


def refuse(wanted: Wanted) -> None:
    """Raises UsageError for what cannot be run, before anything runs: one line."""
    ready_to_run(wanted.scenario)
    if wanted.judge and not wanted.scenario.expect:
        raise UsageError(f"--judge: {NOTHING_EXPECTED}")
    base = wanted.scenario.model_dump(mode="json")
    built = sum(len(axis.texts) for axis in wanted.axes) <= MOST_BUILT
    for number, axis in enumerate(wanted.axes):
        for place in range(len(axis.texts)):
            if wrong := _refused(wanted, base, number, place, built):
                own = wrong.removeprefix(f"{wanted.scenario.name}: ").removeprefix(f"{axis.name}: ")
                raise UsageError(f"{axis.change(place)}: {own}")


def _refused(wanted: Wanted, base: dict[str, Any], number: int, place: int, built: bool) -> str:
    """Why every combination with a value is impossible, of the first; empty if one is possible."""
    first = ""
    for places in islice(_with(wanted.axes, number, place), MOST_TRIED):
        try:
            scenario = changed(base, changes_of(wanted.axes, places), wanted.scenario.name)
            refuse_outside(wanted.measures, scenario)
            if wanted.judge:
                refuse_windows(scenario)
            if built:
                ready_to_run(scenario)
        except UsageError as error:
            first = first or str(error).splitlines()[0]
        else:
            return ""
    return first


def _with(axes: Sequence[Axis], number: int, place: int) -> Iterator[tuple[int, ...]]:
    """Combinations that have one place on one axis."""
    fixed = [axis._replace(texts=axis.texts[:1]) if index == number else axis for index, axis in enumerate(axes)]
    return ((*places[:number], place, *places[number + 1 :]) for places in combinations(fixed))


def run_sweep(wanted: Wanted, folder: Path | None = None, crew: Crew = HERE) -> Found:
    """Run all combinations. Without a folder nothing is kept of an interrupted sweep."""
    base, places = wanted.scenario.model_dump(mode="json"), combinations(wanted.axes)
    points = [_point(wanted, at, index) for index, at in enumerate(places)]
    keep = _room(folder) if wanted.keep and folder else ""
    words = [asked.words for asked in wanted.measures]
    task = partial(run_of, base=base, which=wanted.scenario.name, measures=words, judge=wanted.judge, keep=keep)
    about = {"title": f"sweep of {wanted.scenario.name}", "scenario": base, "measures": words, "judge": wanted.judge}
    about |= law_facts(wanted.scenario.controller)
    found = swept(task, points, about, folder and part_of(folder), crew)
    rows = [Row(at, one["values"], one["reason"], one["failed"]) for at, one in zip(places, found, strict=True)]
    return Found(wanted, rows)


def part_of(folder: Path) -> Path:
    """Where an interrupted sweep leaves what it has."""
    return folder / "sweep.part"


def _room(folder: Path) -> str:
    path = folder.resolve() / "recordings"
    with writing(path):
        path.mkdir(parents=True, exist_ok=True)
    return str(path)


def _point(wanted: Wanted, places: tuple[int, ...], index: int) -> dict[str, Any]:
    named = {"name": KEPT_NAME.format(index + 1)} if wanted.keep else {}
    return {"changes": changes_of(wanted.axes, places)} | named
