"""The circuit of a scenario's rig and its state at rest: made where they are needed, once for the same numbers.

What has been made is kept beside the compiled code, so that a second start needs neither scipy nor the fit of the
lines.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from llvmlite.binding import get_host_cpu_name
from numpy.typing import NDArray

from bridge.errors import ScenarioError
from bridge.scenario.model import Scenario
from twin.cache_folder import version
from twin.circuit.build import build
from twin.circuit.equilibrium import SupplyAtRest, equilibrium, supply_at_rest
from twin.circuit.state import flatten
from twin.circuit.step import Circuit
from twin.kernel import FOLDER
from twin.sealed_files import Files

REMEMBERED = 8  # in a process: a sweep over a number of the rig needs each circuit only for a while
KEPT = 400  # files, of some 20 kB; the oldest go
Plain = tuple[tuple[str, tuple[tuple[str, Any], ...]], ...]  # the rig's values, part by part
T = TypeVar("T")
_lasting: ContextVar[bool] = ContextVar("lasting", default=True)


def circuit_of(scenario: Scenario) -> Circuit:
    """The circuit at the scenario's step. Raises ScenarioError where its numbers make none, or none at this step."""
    try:
        return _circuit(_plain(scenario.rig_values()), scenario.loop.step)
    except ValueError as error:
        raise _refusal(scenario, error) from None


def rest_of(scenario: Scenario) -> NDArray[np.float64]:
    """The flat state in which the scenario starts. Raises ScenarioError where its numbers make none."""
    start = scenario.start
    try:
        return _rest(_plain(scenario.rig_values()), scenario.loop.step, start.position, start.p_upper).copy()
    except ValueError as error:
        raise _refusal(scenario, error) from None


def supply_of(scenario: Scenario) -> SupplyAtRest:
    """Where pump, relief valve and the valve at rest balance. Raises ScenarioError where they do not."""
    try:
        return supply_at_rest(circuit_of(scenario))
    except ValueError as error:
        raise _refusal(scenario, error) from None


def _refusal(scenario: Scenario, error: ValueError) -> ScenarioError:
    """The reason in one line, with a number that likely lacks its unit, which may be behind it."""
    from bridge.scenario.plausible import missing_units

    return ScenarioError("; ".join([f"{scenario.name}: {error}", *missing_units(scenario)]))


def _plain(values: Mapping[str, Mapping[str, Any]]) -> Plain:
    return tuple((part, tuple(entries.items())) for part, entries in values.items())


@lru_cache(REMEMBERED)
def _circuit(values: Plain, step: float) -> Circuit:
    return _kept("circuit", (values, step), lambda: build({part: dict(entries) for part, entries in values}, step))


@lru_cache(REMEMBERED)
def _rest(values: Plain, step: float, position: float, p_upper: float) -> NDArray[np.float64]:
    def make() -> NDArray[np.float64]:
        return flatten(equilibrium(_circuit(values, step), position, p_upper))

    return _kept("rest", (values, step, position, p_upper), make)


@contextmanager
def in_memory() -> Iterator[None]:
    """Keep nothing on disk of what is made inside: rigs that are used once would push out those that come again."""
    token = _lasting.set(False)
    try:
        yield
    finally:
        _lasting.reset(token)


def forget() -> None:
    """Drop what this process remembers; what is kept on disk stays."""
    _circuit.cache_clear()
    _rest.cache_clear()


def _kept(name: str, key: object, make: Callable[[], T]) -> T:
    """What was made for a key before on this kind of processor, or is made now."""
    if FOLDER is None or not _lasting.get():
        return make()
    files = Files(FOLDER / "circuits", name, (get_host_cpu_name(), version("scipy")))
    found = files.load(key)
    if found is None:
        found = make()
        with suppress(OSError):
            files.folder.mkdir(parents=True, exist_ok=True)
            _make_room(files.folder)
            files.save(key, found)
    return found


def _make_room(folder: Path) -> None:
    paths = sorted(folder.iterdir(), key=lambda path: path.stat().st_mtime)
    for path in paths[: max(0, len(paths) - KEPT)]:
        path.unlink(missing_ok=True)
