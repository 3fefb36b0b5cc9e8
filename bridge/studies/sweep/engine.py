"""A sweep: a pure task for each of many points, resumable, its result the same whoever computes it in what order."""

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from bridge.machine.host import versions
from bridge.studies.sweep.crew import Ask, Task, chosen, cores
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
    with rounds(task, about, part, crew) as ask:
        return ask(points)


@contextmanager
def rounds(
    task: Task, about: Mapping[str, Any], part: Path | None, crew: Crew = ALL_CORES, most: int = 0
) -> Iterator["Rounds"]:
    """The same for points that are asked for in several rounds; `part` is removed when all is well in the end.

    most: so many points will be asked for at once; 0: not more than are missing in the first round.
    """
    journal = None if part is None else Journal(part, identity(task, about))
    with ExitStack() as stack:

        def start(missing: int) -> Ask:
            return stack.enter_context(chosen(task, most or missing, crew.workers or cores(), crew.scheduler))

        yield Rounds(start, journal, str(about.get("title", "sweep")))
    if journal is not None:
        journal.remove()


class Rounds:
    """Points asked for in rounds, each computed once. Whoever computes is started with the first that is missing."""

    def __init__(self, start: Callable[[int], Ask], journal: Journal | None, title: str) -> None:
        self.computed = 0  # points, here and now
        self._start, self._journal, self._title = start, journal, title
        self._found = {} if journal is None else dict(journal.found)
        self._crew: Ask | None = None

    def __call__(self, points: Sequence[Point]) -> list[Result]:
        """The results in the order of the points."""
        missing = list({key_of(p): p for p in points if key_of(p) not in self._found}.values())
        if missing:
            self._compute(missing, len(points))
        return [self._found[key_of(point)] for point in points]

    def _compute(self, missing: list[Point], total: int) -> None:
        self._crew = self._crew or self._start(len(missing))
        with progress(self._title, total, total - len(missing)) as advance:
            for point, result in self._crew(missing):
                if self._journal is not None:
                    self._journal.add(point, result)
                self._found[key_of(point)] = result
                self.computed += 1
                advance()


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
