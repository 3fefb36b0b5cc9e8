"""The matrix of a campaign: every run that it asks for, in one order, each with the point that makes it."""

import math
from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any, NamedTuple

from bridge.errors import UsageError
from bridge.runs.campaign.draws import drawn, value_at
from bridge.runs.campaign.file import CampaignFile, Fault
from bridge.runs.campaign.made import scenario_of
from bridge.runs.campaign.places import number_at, on_grid
from bridge.runs.sweep.axes import Axis, axes_from
from bridge.scenario import Scenario, check
from bridge.scenario.faults import PROCESS_OF, planned
from bridge.scenario.files import plain, with_piece
from bridge.scenario.measures import Measure, measures_of, refuse_outside
from bridge.studies.sweep.journal import Point

MOST_RUNS = 100_000
MOST_TRIED = 2_000  # combinations that are checked before anything runs
MOST_BUILT = 100  # of which the rig is built before anything runs
NOT_THERE = ""  # the value of a number whose fault a run does not have


class Matrix(NamedTuple):
    """A campaign whose scenarios are loaded and whose numbers are read."""

    file: CampaignFile
    scenarios: dict[str, Scenario]  # with what is common to all
    bases: dict[str, dict[str, Any]]  # the same, plain
    parameters: list[Axis]
    measures: list[Measure]

    @property
    def pieces(self) -> dict[str, dict[str, Any]]:
        """Of the faults, by name."""
        return {fault.name: fault.piece for fault in self.file.faults}


class Run(NamedTuple):
    """One run of the matrix."""

    number: int  # from 1
    scenario: str
    fault: str
    parameters: tuple[str, ...]  # with their units; NOT_THERE for a number of another fault
    drawn: tuple[str, ...]
    seed: int
    point: Point

    @property
    def cell(self) -> tuple[str, str, tuple[str, ...]]:
        """What it shares with runs of other seeds and draws."""
        return self.scenario, self.fault, self.parameters


def matrix_of(file: CampaignFile) -> Matrix:
    """Load the scenarios and read what is varied. Raises UsageError with one line."""
    for fault in file.faults:
        if fault.name in Scenario.model_fields:
            raise UsageError(f"faults.{fault.name}: a section of scenarios is called so; take another name")
    scenarios = dict(_scenarios(file))
    first = next(iter(scenarios.values()))
    try:
        parameters = axes_from(file.parameters, first) if file.parameters else []
    except (TypeError, ValueError) as error:
        raise UsageError(f"parameters: {error}") from None
    for place in [*(axis.name for axis in parameters), *(draw.place for draw in file.draws)]:
        if (fault := fault_of(place, file)) is not None:
            number_at(fault.piece, place.removeprefix(f"{fault.name}."), fault.name)
    if twice := {axis.name for axis in parameters} & {draw.place for draw in file.draws}:
        raise UsageError(f"{min(twice)} is a parameter and drawn; leave one of the two out")
    measures = measures_of(file.metrics) if file.metrics else []
    bases = {name: scenario.model_dump(mode="json") for name, scenario in scenarios.items()}
    return Matrix(file, scenarios, bases, parameters, measures)


def _scenarios(file: CampaignFile) -> Iterator[tuple[str, Scenario]]:
    names = []
    for which in file.scenarios:
        beside = file.folder / which
        data = plain(str(beside) if beside.is_file() else which)
        scenario = check(with_piece(data, file.common), which)
        if scenario.name in names:
            raise UsageError(f"scenarios: two are called {scenario.name!r}; give one of them another name")
        if not scenario.expect:
            raise UsageError(f"{which}: states no band to judge by; write what it must meet in common.expect")
        names.append(scenario.name)
        yield scenario.name, scenario


def fault_of(place: str, file: CampaignFile) -> Fault | None:
    """The fault that a place such as "push.timeline.1.to" belongs to; None for one of the scenario."""
    return next((fault for fault in file.faults if place.startswith(f"{fault.name}.")), None)


def faults_for(matrix: Matrix, scenario: str) -> list[Fault]:
    """The columns that are meant for a scenario."""
    given = dict(zip(matrix.scenarios, matrix.file.scenarios, strict=True))
    return [f for f in matrix.file.faults if not f.scenarios or {scenario, given[scenario]} & set(f.scenarios)]


def step_of(matrix: Matrix, place: str) -> float:
    """The grid [s] of a time at a place, that of the coarsest scenario."""
    daq = place in ("duration", "loop.sample_period", "loop.offset")
    return max(s.loop.daq_period if daq else s.loop.step for s in matrix.scenarios.values())


def counted(matrix: Matrix) -> tuple[int, str]:
    """How many runs there are, and in words why."""
    file = matrix.file
    cells = sum(len(_places(matrix, fault)) for name in matrix.scenarios for fault in faults_for(matrix, name))
    seeds = len(file.seeds) if file.seeds else 1
    factors = [(cells, "cells of scenario, fault and parameters"), (max(1, file.drawn), "draws"), (seeds, "seeds")]
    runs = math.prod(number for number, _ in factors)
    return runs, " x ".join(f"{number} {words}" for number, words in factors)


def runs_of(matrix: Matrix) -> list[Run]:
    """All runs, the seed turning fastest, then draws, parameters, faults, scenarios. Raises UsageError for too many."""
    number, words = counted(matrix)
    if number > MOST_RUNS:
        raise UsageError(f"{number} runs ({words}) are more than {MOST_RUNS}; take fewer values, draws or seeds")
    if number == 0:
        raise UsageError("the matrix is empty: no fault is meant for any of the scenarios")
    file = matrix.file
    columns = [drawn(draw, file.draw_seed, file.drawn, step_of(matrix, draw.place)) for draw in file.draws]
    rows = list(enumerate(zip(*columns, strict=True), 1)) if columns else [(0, ())]
    cells = (
        (name, fault, texts)
        for name in matrix.scenarios
        for fault in faults_for(matrix, name)
        for texts in _places(matrix, fault)
    )
    found: list[Run] = []
    for (name, fault, texts), (at, row) in product(cells, rows):
        own = tuple(
            text if _applies(draw.place, fault, file) else NOT_THERE for draw, text in zip(file.draws, row, strict=True)
        )
        for seed in file.seeds or [at or matrix.scenarios[name].seed]:
            point = _point(matrix, name, fault, texts, own, seed)
            found.append(Run(len(found) + 1, name, fault.name, texts, own, seed, point))
    return found


def _places(matrix: Matrix, fault: Fault) -> list[tuple[str, ...]]:
    """The combinations of parameters for a fault: a number of another one has one place only."""
    return list(
        product(*(a.texts if _applies(a.name, fault, matrix.file) else (NOT_THERE,) for a in matrix.parameters))
    )


def _applies(place: str, fault: Fault, file: CampaignFile) -> bool:
    return fault_of(place, file) in (None, fault)


def _point(
    matrix: Matrix, name: str, fault: Fault, texts: Sequence[str], own: Sequence[str], seed: int
) -> dict[str, Any]:
    pairs = [*zip((axis.name for axis in matrix.parameters), texts, strict=True)]
    pairs += zip((draw.place for draw in matrix.file.draws), own, strict=True)
    values = {place: text for place, text in pairs if text != NOT_THERE}
    of_fault = {place: text for place, text in values.items() if fault_of(place, matrix.file)}
    placed = {place.removeprefix(f"{fault.name}."): text for place, text in of_fault.items()}
    changes = [f"{place}={text}" for place, text in values.items() if place not in of_fault]
    placed_part = {"placed": placed} if placed else {}
    return {"scenario": name, "fault": fault.name, "changes": [*changes, f"seed={seed}"]} | placed_part


def refuse(matrix: Matrix, runs: Sequence[Run]) -> None:
    """Raises UsageError for what cannot be run, before anything runs: one line that names the column.

    A combination with a drawn number may be impossible: its run fails then, with the reason.
    """
    from bridge.runs.check import refuse_windows
    from bridge.runs.run import ready_to_run

    seen = {}
    for run in runs:
        seen.setdefault(run.cell, run)
    for count, run in enumerate(list(seen.values())[:MOST_TRIED]):
        point = middle(matrix, run)
        try:
            scenario = scenario_of(point, matrix.bases, matrix.pieces)
            refuse_windows(scenario)
            refuse_outside(matrix.measures, scenario)
            _refuse_process_faults(scenario)
            if count < MOST_BUILT:
                ready_to_run(scenario)
        except UsageError as error:
            line = str(error).splitlines()[0].removeprefix(f"{run.scenario}: ")
            where = [run.scenario, *([f"faults.{run.fault}"] if matrix.pieces[run.fault] else [])]
            where += [change for change in point["changes"] if not change.startswith("seed=")]
            raise UsageError(f"{', '.join(where)}: {line}") from None


def _refuse_process_faults(scenario: Scenario) -> None:
    for fault in planned(scenario):
        if fault.target.startswith(f"{PROCESS_OF}."):
            raise UsageError(
                f"fault {fault.name}: faults of processes need real time, which campaigns do not have; "
                "take a fault of the link, such as kind 'freeze'"
            )


def middle(matrix: Matrix, run: Run) -> Point:
    """The point of a run with the median of each drawn number."""
    fault = next(fault for fault in matrix.file.faults if fault.name == run.fault)
    pairs = zip(matrix.file.draws, run.drawn, strict=True)
    own = [
        text and draw.text(on_grid(value_at(draw, 0.5), draw.unit, step_of(matrix, draw.place))) for draw, text in pairs
    ]
    return _point(matrix, run.scenario, fault, run.parameters, own, run.seed)
