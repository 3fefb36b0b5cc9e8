"""A fit from files: recordings in, numbers with their uncertainty out, judged on other recordings."""

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bridge.errors import UsageError
from bridge.recording.imported import facts
from bridge.scenario import Scenario, changed, check, load
from bridge.scenario.units import once
from bridge.studies.identification.alone import Ranked, ranked
from bridge.studies.identification.data import Record, in_steps, only_moving, with_noise
from bridge.studies.identification.fit import Fitted, Values, fit
from bridge.studies.identification.noise import stated_by_hand
from bridge.studies.identification.parameters import Parameter, parameters_of, priors_of
from bridge.studies.identification.recorded import record_of, same_grid
from bridge.studies.identification.residuals import Residuals, Task
from bridge.studies.identification.simulation import shots_of
from bridge.studies.identification.starts import Starts, from_several
from bridge.studies.identification.uncertainty import Uncertainty, uncertainty
from bridge.studies.identification.whiteness import Whiteness, whiteness
from bridge.studies.sweep.crew import cores
from bridge.studies.sweep.engine import Crew


class Wanted(NamedTuple):
    """A fit, as asked for; plain data."""

    files: tuple[str, ...]
    judge: tuple[str, ...]
    scenario: Mapping[str, Any]  # the rig to start with, as plain data
    fit: tuple[str, ...]
    priors: tuple[str, ...] = ()
    noise: tuple[tuple[str, str], ...] = ()  # deviations by signal, as written: "0.05 bar"; SI without a unit
    length: float | None = None  # of shots [s]
    moving: bool = False
    each: bool = False  # find the one number that explains most, and fit that alone


class Prepared(NamedTuple):
    """The same, read."""

    base: tuple[Values, float]  # values of the rig, and the step [s]
    records: list[Record]
    parameters: list[Parameter]


class Judged(NamedTuple):
    """What came of a fit."""

    wanted: Wanted
    scenario: Scenario
    found: Fitted
    known: Uncertainty
    held: Fitted | None  # the recordings it is judged on, with its numbers
    judged: list[Whiteness]
    before: list[Whiteness]  # the fitted recordings with the numbers to start with
    starts: Starts | None
    ranked: Ranked | None  # each number alone
    seconds: float  # CPU, of all that this process has done for it

    @property
    def runs(self) -> int:
        """Simulations of all stretches once, of each number alone as well."""
        return self.found.runs + (0 if self.ranked is None else sum(one.runs for one in self.ranked.tried))


def prepared(wanted: Wanted) -> Prepared:
    """Read what a fit needs. Raises UsageError."""
    scenario = check(dict(wanted.scenario), "the rig")
    parameters = parameters_of(wanted.fit, scenario, priors_of(wanted.priors))
    return Prepared((scenario.rig_values(), scenario.loop.step), records_of(wanted, wanted.files), parameters)


def records_of(wanted: Wanted, files: Sequence[str]) -> list[Record]:
    """Records of files. Raises UsageError."""
    step = float(check(dict(wanted.scenario), "the rig").loop.step)
    found = []
    for file in files:
        record = record_of(Path(file))
        try:
            record = in_steps(record, step)
        except ValueError as error:
            raise UsageError(f"{file}: {error}; take another loop.step") from None
        if record.signal("position") is None:
            raise UsageError(f"{file}: holds no position; without one nothing says where the rod is")
        record = with_noise(record, deviations_of(wanted.noise, record, file))
        found.append(only_moving(record) if wanted.moving else record)
    same_grid(found)
    shots_of(found, math.inf)  # refuses a record in which no shot can begin, before anything is fitted
    return found


def deviations_of(noise: Sequence[tuple[str, str]], record: Record, file: str) -> dict[str, tuple[float, str]]:
    """Deviations of signals of a record [SI], and notes on them. Raises UsageError."""
    units, found = {signal.name: signal.unit for signal in record.signals}, {}
    for name, text in noise:
        if name not in units:
            raise UsageError(f"--noise {name}: {file} has {', '.join(units)}")
        try:
            found[name] = stated_by_hand(name, text, units[name])
        except ValueError as error:
            raise UsageError(once(f"--noise {name}", "=", text, error)) from None
    return found


def identify(wanted: Wanted, starts: int, part: Path | None, crew: Crew) -> Judged:
    """Fit, and judge. Raises UsageError, RunError."""
    import time

    began = time.process_time()
    ready = prepared(wanted)
    held = records_of(wanted, wanted.judge)
    with threads(crew) as own:
        order = ranked(*ready, own) if wanted.each else None
        if order is not None:
            best = order.tried[0].parameter.name
            ready = ready._replace(parameters=[one for one in ready.parameters if one.name == best])
        several = from_several(wanted, ready.parameters, starts, part, crew) if starts > 1 else None
        start = np.array([order.tried[0].place]) if order is not None else None
        if several is not None:
            start = several.best
        found = fit(*ready, start=start, length=wanted.length, crew=own)
        before = found._replace(places=0.0 * found.places, shots=Residuals(found.task, own).afresh(0.0 * found.places))
        other = on_others(found, held, own) if held else None
    scenario = check(dict(wanted.scenario), "the rig")
    judged = [] if other is None else whiteness(other)
    known, first = uncertainty(found), whiteness(before)
    seconds = time.process_time() - began
    return Judged(wanted, scenario, found, known, other, judged, first, several, order, seconds)


def on_others(found: Fitted, records: Sequence[Record], crew: Executor | None = None) -> Fitted:
    """Other records with the numbers of a fit; only the starts of the shots are found anew."""
    task = found.task._replace(records=records, shots=shots_of(records, found.length))
    return found._replace(task=task, shots=Residuals(task, crew).afresh(found.places))


def threads(crew: Crew) -> AbstractContextManager[Executor | None]:
    """Threads for the simulations of one fit: these do not hold the interpreter."""
    count = crew.workers or cores()
    return nullcontext() if count == 1 else ThreadPoolExecutor(count)


def scenario_of(rig: str | None, changes: list[str], files: Sequence[str]) -> tuple[Scenario, str]:
    """The rig to start with, and what the result extends. Raises UsageError."""
    from bridge.recording.reader import read
    from bridge.scenario import names

    if rig is not None:
        return load(rig, changes), rig
    recording = read(Path(files[0]), ())
    recorded = recording.scenario()
    mapped = facts(recording).get("mapped", {})
    extends = str(mapped.get("rig", recorded.name))
    if extends not in names():
        raise UsageError(f"{files[0]} is of the rig {extends!r}, which is not built in: name its file with --rig")
    known = changed(recorded.model_dump(mode="json"), changes, files[0]) if changes else recorded
    return known, extends


__all__ = ["Judged", "Task", "Wanted", "identify", "scenario_of"]
