"""Scenarios and runs for users' programs."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

import bridge.recording.reader as recordings
from bridge.errors import UsageError, nearest
from bridge.loop.law import facts_of, law_object
from bridge.recording.reader import Recording
from bridge.recording.signals import COMPARED, INSTANTS, signals_of
from bridge.recording.summarise import known_or_made
from bridge.recording.summary import Summary
from bridge.recording.verdict import verdict
from bridge.recording.writer import save
from bridge.runs.check import Judgement, judge_run
from bridge.runs.in_process import run_in_memory
from bridge.scenario import Scenario
from bridge.scenario import load as load_scenario
from bridge.scenario.units import quantity
from controller.bands import Metrics
from controller.grid import NS
from hydrotwin.signal import Quantity, Signal

if TYPE_CHECKING:
    from bridge.studies.linear_model import LinearModel

Changes = Mapping[str, Any] | Iterable[str]
Law = Callable[..., Any]  # (sample, target, memory, gains) -> (spool, memory)


def load(source: str | Path, changes: Changes = ()) -> Scenario:
    """A built-in scenario by its name, or one in a TOML file, with some of its values changed.

    changes: {"controller.gain": "2 V/%", "loop": {"delay": 0.01}}, or ["controller.gain=2 V/%"]. Raises ScenarioError.
    """
    words = _flat(changes) if isinstance(changes, Mapping) else changes
    return load_scenario(str(source), list(words))


def run(scenario: Scenario | str | Path, law: Law | None = None, changes: Changes = ()) -> "Run":
    """Run a scenario in this process, as fast as it goes; the same numbers as in lockstep and in clean real time.

    law: a function in place of the scenario's own law; it is given the scenario's gains, and its source goes into the
    recording. Raises ScenarioError, and RunError with file and line where the law fails.
    """
    if not isinstance(scenario, Scenario):
        scenario = load(scenario, changes)
    elif changes:
        raise UsageError("changes go with the name of a scenario: load(name, changes) makes the changed one")
    if law is None:
        return Run(run_in_memory(scenario, aloud=True), scenario)
    return Run(run_in_memory(scenario, law_object(law), facts_of(law), aloud=True), scenario)


def linear_model(scenario: Scenario | str, point: str = "rest", friction: Quantity = 0.0) -> "LinearModel":
    """The linear model of a rig about a point: "rest", "up", "down", or a spool position such as "0.3".

    friction: viscous, in place of the seal's, a number in N s/m or "20 kN s/m". Raises ScenarioError for a point that
    the rig does not have.
    """
    from bridge.studies.linear_model import linear_model as model_of

    loaded = scenario if isinstance(scenario, Scenario) else load(scenario)
    return model_of(loaded, point, quantity(friction, "N s/m"))


def read(path: str | Path) -> "Run":
    """A recorded run. Raises UsageError where there is none."""
    found = recordings.read(Path(path))
    return Run(found, found.scenario())


class Run:
    """A run: its signals, metrics and verdicts."""

    def __init__(self, recording: Recording, scenario: Scenario) -> None:
        self.recording = recording
        self.scenario = scenario

    def __repr__(self) -> str:
        return f"<run of {self.scenario.name!r}: {self.summary.ending}>"

    @cached_property
    def summary(self) -> Summary:
        """How it went, as `hydrotwin run` prints it."""
        return known_or_made(self.recording, self.scenario)

    @property
    def metrics(self) -> Metrics:
        """Rise time, overshoot, limit cycle and so on, SI; NaN where one does not apply. Raises UsageError without."""
        if self.summary.metrics is None:
            raise UsageError(f"{self.scenario.name}: the run holds no state, so it has no metrics")
        return self.summary.metrics

    @cached_property
    def bands(self) -> list[Judgement]:
        """The verdict on each band that the scenario expects: text, found, passed."""
        return judge_run(self.scenario, self.summary, self.recording)

    @cached_property
    def faults(self) -> list[str]:
        """What makes the run itself a bad one, the main reason first: refused commands, a safe state, an early end."""
        return verdict(self.summary, self.scenario)

    @property
    def passed(self) -> bool:
        """Did the run and every band go well?"""
        return not self.faults and all(band.passed for band in self.bands)

    def signal(self, name: str) -> Signal:
        """A quantity: "p2" as the card read it, "p_lower" as it truly was; "state.position" where both have it.

        A bare name is looked for in state, measurement, command and reference. Raises UsageError with the nearest.
        """
        found = self._signals
        candidates = [name, *(f"{topic}.{name}" for topic in ("state", *COMPARED))]
        full = next((candidate for candidate in candidates if candidate in found), None)
        if full is None:
            known = [*found, *(entry.partition(".")[2] for entry in found)]
            raise UsageError(f"no signal {name!r}{nearest(name, known)}")
        signal = found[full]
        return Signal(name, signal.unit, signal.stamp / NS, signal.value)

    def columns(self, topic: str = "state") -> dict[str, NDArray[Any]]:
        """A topic as one array per field, SI, as they were recorded."""
        return self.recording.columns(topic)

    def frame(self, topic: str = "state", library: Literal["pandas", "polars"] = "pandas") -> Any:
        """A topic as a frame of pandas or polars, by time [s]. Raises UsageError where the library is not installed."""
        package = frames(library)
        columns = {name: np.ascontiguousarray(values) for name, values in self.columns(topic).items()}
        return package.DataFrame({"time": columns[INSTANTS.get(topic, "stamp")] / NS} | columns)

    def save(self, path: str | Path) -> Path:
        """Write the recording, for `hydrotwin view`, `report` and `compare`."""
        return save(self.recording, Path(path), self.scenario.rig_name)

    @cached_property
    def _signals(self) -> dict[str, Any]:
        return signals_of(self.recording)


def frames(library: str) -> Any:
    """The package whose frames are wanted. Raises UsageError for another one, and where it is not installed."""
    if library not in ("pandas", "polars"):
        raise UsageError(f"library {library!r}: frames are of 'pandas' or 'polars'")
    try:
        return import_module(library)
    except ImportError:
        raise UsageError(f"no package {library!r}: pip install {library}, or use columns()") from None


def _flat(changes: Mapping[str, Any], before: str = "") -> Iterator[str]:
    for key, value in changes.items():
        name = f"{before}{key}"
        if isinstance(value, Mapping):
            yield from _flat(value, f"{name}.")
        else:
            yield f"{name}={value if isinstance(value, str) else json.dumps(value)}"
