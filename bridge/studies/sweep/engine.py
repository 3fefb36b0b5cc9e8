"""A sweep: a pure task for each of many points, resumable, its result the same whoever computes it in what order."""

import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any, NamedTuple

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from bridge.machine.host import versions
from bridge.studies.sweep.crew import Done, Task, chosen, cores
from bridge.studies.sweep.journal import (
    Journal,
    Point,
    Result,
    key_of,
)
from twin.cache_folder import fingerprint

SAID_EVERY = 10.0  # [s], where nobody watches


class Crew(NamedTuple):
    """Who computes."""

    workers: int  # processes of this machine
    scheduler: str | None  # address of a Dask scheduler instead


ALL_CORES = Crew(0, None)
HERE = Crew(1, None)


def sweep(
    task: Task, points: Sequence[Point], about: Mapping[str, Any], part: Path | None, crew: Crew = ALL_CORES
) -> list[Result]:
    """The results in the order of the points.

    part: file that keeps what has been found until the sweep is whole, then is removed; None keeps nothing. about:
    what else the results depend on. Raises UsageError when `part` belongs to another sweep, RunError when the
    cluster does not answer, and whatever the task raises.
    """
    journal = None if part is None else Journal(part, identity(task, about))
    found = {} if journal is None else dict(journal.found)
    missing = [point for point in points if key_of(point) not in found]
    title, workers = str(about.get("title", "sweep")), crew.workers or cores()
    standing = chosen(task, len(missing), workers, crew.scheduler) if missing else nullcontext(_nobody)
    with progress(title, len(points), len(points) - len(missing)) as advance, standing as ask:
        for point, result in ask(missing):
            if journal is not None:
                journal.add(point, result)
            found[key_of(point)] = result
            advance()
    if journal is not None:
        journal.remove()
    return [found[key_of(point)] for point in points]


def _nobody(points: Sequence[Point]) -> Done:
    return iter(())


def identity(task: Task, about: Mapping[str, Any]) -> dict[str, Any]:
    """What a journal must agree on: the task, what it is about, and the sources of the twin."""
    named = getattr(task, "func", task)
    own = {"task": f"{named.__module__}.{named.__qualname__}", "twin": fingerprint()}
    return {**own, "hydrotwin": versions().get("hydrotwin", ""), **about}


@contextmanager
def progress(title: str, total: int, done: int) -> Iterator[Any]:
    """A bar on standard error; a line now and then where that is not a terminal."""
    if sys.stderr.isatty():
        columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
        with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
            shown = bar.add_task(title, total=total, completed=done)
            yield lambda: bar.advance(shown)
        return
    yield _Lines(title, total, done)


class _Lines:
    """Progress as lines."""

    def __init__(self, title: str, total: int, done: int) -> None:
        self.title, self.total, self.done = title, total, done
        self.said = self.begun = time.monotonic()

    def __call__(self) -> None:
        self.done += 1
        if time.monotonic() - self.said >= SAID_EVERY:
            self.said = time.monotonic()
            print(f"{self.title}: {self.done} of {self.total}, {self.said - self.begun:.0f} s", file=sys.stderr)
