"""A campaign from its matrix to what was found: runs, margins, smallest faults, pictures of what failed worst."""

import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from bridge.runs.campaign.made import Plain
from bridge.runs.campaign.margins import Margin, margins_of, theory_of
from bridge.runs.campaign.matrix import Matrix, Run
from bridge.runs.campaign.picture import pictured
from bridge.runs.campaign.point import judged
from bridge.runs.campaign.shrink import Shrunk, Wish, shrunk
from bridge.scenario.law_file import law_facts
from bridge.studies.sweep.engine import Crew, Rounds, rounds
from bridge.studies.sweep.journal import Point, Result

PART = "campaign.part"  # what an interrupted campaign leaves in its folder


class Judged(NamedTuple):
    """A run and what it came to."""

    run: Run
    result: Result

    @property
    def passed(self) -> bool:
        """Did it go well, in all its bands?"""
        return not self.result["reason"] and all(band["passed"] for band in self.result["bands"])

    @property
    def broken(self) -> list[str]:
        """What it broke, the worst first: why the run failed, then bands."""
        bands = sorted((b for b in self.result["bands"] if not b["passed"]), key=lambda band: -band["excess"])
        words = [f"{band['id']}: {band['band']}" if band["id"] else band["band"] for band in bands]
        return ([self.result["reason"]] if self.result["reason"] else []) + words

    @property
    def badness(self) -> tuple[bool, float]:
        """What orders failed runs: one that failed altogether is worse than one beyond a band, however far."""
        return bool(self.result["reason"]), max((band["excess"] for band in self.result["bands"]), default=0.0)


class Failure(NamedTuple):
    """Runs of one scenario and fault that break the same thing first, the worst of them first."""

    runs: list[Judged]
    of: int  # runs of that scenario and fault

    @property
    def worst(self) -> Judged:
        """The run that says most."""
        return self.runs[0]


class Found(NamedTuple):
    """A campaign and what it came to."""

    matrix: Matrix
    runs: list[Judged]
    margins: list[Margin]
    shrunk: list[Shrunk]
    failures: list[Failure]  # worst first
    pictures: dict[int, str]  # by the number of a run

    @property
    def passed(self) -> int:
        """How many runs passed."""
        return sum(one.passed for one in self.runs)

    @property
    def accepted(self) -> bool:
        """Did enough of them?"""
        return self.passed >= self.matrix.file.accept * len(self.runs) - 1e-9


class Pace(NamedTuple):
    """How fast it went: of this call alone, since an interrupted campaign has runs of earlier ones."""

    runs: int
    seconds: float
    workers: int

    @property
    def words(self) -> str:
        """For people."""
        per = self.runs / self.seconds if self.seconds > 0.0 else 0.0
        cores = f"{self.workers} process{'es' * (self.workers != 1)}"
        rate = f"{per:.2f} runs per second, {per / self.workers:.2f} per second and process"
        return f"{self.runs} runs computed in {self.seconds:.1f} s by {cores}: {rate}"


def worked(point: Point, bases: Mapping[str, Plain], pieces: Mapping[str, Plain], **how: Any) -> Result:
    """What a worker does with a point: run and judge it, draw it, or ask the theory."""
    if "theory" in point:
        return theory_of(point, bases)
    return pictured(point, bases, pieces) if "picture" in point else judged(point, bases, pieces, **how)


def rounds_of(matrix: Matrix, folder: Path | None, crew: Crew, most: int) -> Any:
    """Whoever computes, with a journal in the folder: a context manager. The journal is removed when all is well."""
    file = matrix.file
    how = {"measures": [asked.words for asked in matrix.measures], "mode": str(file.mode)}
    task = partial(worked, bases=matrix.bases, pieces=matrix.pieces, **how)
    laws = {name: law_facts(scenario.controller) for name, scenario in matrix.scenarios.items()}
    about = {"title": file.name, "scenarios": matrix.bases, "faults": matrix.pieces, "laws": laws, **how}
    return rounds(task, about, folder and folder / PART, crew, most)


def run_campaign(matrix: Matrix, runs: Sequence[Run], wishes: Sequence[Wish], ask: Rounds) -> Found:
    """Everything that a campaign asks for, in this order."""
    found = [Judged(run, one) for run, one in zip(runs, ask([run.point for run in runs]), strict=True)]
    margins = margins_of(matrix, ask)
    smallest = shrunk(wishes, matrix, runs, ask)
    failures = failures_of(found)
    shown = [failure.worst.run for failure in failures[: matrix.file.pictures]]
    drawn = ask([{**run.point, "picture": f"run{run.number}"} for run in shown])
    pictures = {run.number: one["svg"] for run, one in zip(shown, drawn, strict=True) if one["svg"]}
    return Found(matrix, found, margins, smallest, failures, pictures)


def failures_of(found: Sequence[Judged]) -> list[Failure]:
    """What failed, worst first: of each scenario and fault the runs that break the same thing first."""
    groups: dict[tuple[str, str, str], list[Judged]] = {}
    totals: dict[tuple[str, str], int] = {}
    for one in found:
        column = one.run.scenario, one.run.fault
        totals[column] = totals.get(column, 0) + 1
        if not one.passed:
            groups.setdefault((*column, "" if one.result["reason"] else one.broken[0]), []).append(one)
    ordered = [sorted(group, key=lambda one: one.badness, reverse=True) for group in groups.values()]
    failures = [Failure(group, totals[group[0].run.scenario, group[0].run.fault]) for group in ordered]
    return sorted(failures, key=lambda failure: failure.worst.badness, reverse=True)


class Watch:
    """How long something takes."""

    def __init__(self) -> None:
        self._begin = time.monotonic()

    @property
    def seconds(self) -> float:
        """Since it was made."""
        return time.monotonic() - self._begin
