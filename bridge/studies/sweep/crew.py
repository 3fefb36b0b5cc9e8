"""Who computes the points of a sweep: this process, one process per core, or the workers of a Dask cluster."""

import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial

from bridge.errors import RunError
from bridge.machine.children import guarded
from bridge.studies.sweep.journal import Point, Result

UNTOLD = "ignore:resource_tracker:UserWarning"  # what Python's cleaner of semaphores says after Ctrl-C has ended us
WAY_OUT = "memory may have run out; run it again with fewer --workers"

Task = Callable[[Point], Result]  # importable by name, pure
Done = Iterator[tuple[Point, Result]]  # in the order in which they come
Ask = Callable[[Sequence[Point]], Done]  # of a crew that stands ready: once or many times


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def alone(task: Task, points: Sequence[Point]) -> Done:
    """Here, one after the other."""
    for point in points:
        yield point, task(point)


@contextmanager
def local(task: Task, workers: int) -> Iterator[Ask]:
    """Processes of this machine. They are new ones and inherit no thread of this one. RunError when one dies."""
    spawn = multiprocessing.get_context("spawn")
    if UNTOLD not in sys.warnoptions:  # a new Python takes them over from here
        sys.warnoptions.append(UNTOLD)
    with guarded() as environment, ProcessPoolExecutor(workers, spawn) as pool:

        def ask(points: Sequence[Point]) -> Done:
            with _starting(environment):
                asked = {pool.submit(task, point): point for point in points}
            for future in as_completed(asked):
                yield asked[future], future.result()

        try:
            yield ask
        except BrokenProcessPool:
            raise RunError(f"a worker process was killed: {WAY_OUT}") from None
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


@contextmanager
def _starting(environment: dict[str, str]) -> Iterator[None]:
    """Children that start meanwhile get this environment, and leave Ctrl-C at the terminal to us."""
    before = dict(os.environ)
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT,))
    os.environ |= environment
    try:
        yield
    finally:
        os.environ.clear()
        os.environ |= before
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


@contextmanager
def cluster(task: Task, address: str) -> Iterator[Ask]:
    """The workers of a Dask scheduler. Raises RunError when there is none at the address, or no Dask here."""
    try:
        from distributed import Client
        from distributed import as_completed as completed
    except ImportError:
        raise RunError("--scheduler needs Dask: pip install 'hydrotwin[sweep]'") from None
    try:
        client = Client(address, timeout="10s")
    except (OSError, ValueError, TimeoutError) as error:
        raise RunError(f"no Dask scheduler answers at {address}: {error}") from None
    with client:

        def ask(points: Sequence[Point]) -> Done:
            futures = client.map(task, points, pure=False)
            asked = {future.key: point for future, point in zip(futures, points, strict=True)}
            for future in completed(futures):
                yield asked[future.key], future.result()

        yield ask


@contextmanager
def chosen(task: Task, most: int, workers: int, scheduler: str | None) -> Iterator[Ask]:
    """Whoever the options ask for; `most`: so many points will be asked for at once."""
    if scheduler is not None:
        with cluster(task, scheduler) as ask:
            yield ask
    elif workers == 1 or most < 2:
        yield partial(alone, task)
    else:
        with local(task, min(workers, most)) as ask:
            yield ask
