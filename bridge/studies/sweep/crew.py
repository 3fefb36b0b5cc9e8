"""Who computes the points of a sweep: this process, a process a core, or the workers of a Dask cluster."""

import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed

from bridge.errors import RunError
from bridge.studies.sweep.journal import Point, Result

Task = Callable[[Point], Result]  # importable by name, pure
Done = Iterator[tuple[Point, Result]]  # in the order in which they come


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def alone(task: Task, points: Sequence[Point]) -> Done:
    """Here, one after the other."""
    for point in points:
        yield point, task(point)


def local(task: Task, points: Sequence[Point], workers: int) -> Done:
    """In processes of this machine. They are new ones and inherit no thread of this one."""
    with ProcessPoolExecutor(min(workers, len(points)), multiprocessing.get_context("spawn")) as pool:
        asked = {pool.submit(task, point): point for point in points}
        try:
            for future in as_completed(asked):
                yield asked[future], future.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def cluster(task: Task, points: Sequence[Point], address: str) -> Done:
    """On the workers of a Dask scheduler. Raises RunError when there is none at the address, or no Dask here."""
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
        futures = client.map(task, points, pure=False)
        asked = {future.key: point for future, point in zip(futures, points, strict=True)}
        for future in completed(futures):
            yield asked[future.key], future.result()


def chosen(task: Task, points: Sequence[Point], workers: int, scheduler: str | None) -> Done:
    """Whoever the options ask for."""
    if scheduler is not None:
        return cluster(task, points, scheduler)
    if workers == 1 or len(points) < 2:
        return alone(task, points)
    return local(task, points, workers)
