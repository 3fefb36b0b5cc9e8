"""Sweeps for users' programs: a scenario at every combination of some of its values."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError
from bridge.runs.sweep.axes import axes_from
from bridge.runs.sweep.sweep import Found, Wanted, refuse, run_sweep
from bridge.runs.sweep.table import plain, write_csv
from bridge.scenario import Scenario
from bridge.scenario.measures import measures_of
from bridge.studies.sweep.engine import Crew
from hydrotwin.runs import Changes, frames, load


def sweep(
    scenario: Scenario | str | Path,
    axes: Mapping[str, str | Sequence[Any]],
    metrics: str | Sequence[str] = "rms error",
    changes: Changes = (),
    judge: bool = False,
    workers: int = 1,
) -> "Sweep":
    """Run a scenario at every combination of some of its values.

    axes: {"controller.gain": "0.5:4:8", "loop.delay": ["0 ms", "10 ms"]}; a number in a list that has no unit is SI.
    metrics: what bands can name. judge: also the scenario's own bands. workers: processes; 0 for one per core, and a
    program that asks for more than one guards its own start with `if __name__ == "__main__"`. Raises UsageError.
    """
    if isinstance(scenario, Scenario) and changes:
        raise UsageError("changes go with the name of a scenario: load(name, changes) makes the changed one")
    loaded = scenario if isinstance(scenario, Scenario) else load(scenario, changes)
    asked = measures_of([metrics] if isinstance(metrics, str) else list(metrics))
    wanted = Wanted(loaded, axes_from(axes, loaded), asked, judge)
    refuse(wanted)
    return Sweep(run_sweep(wanted, crew=Crew(workers, None)))


class Sweep:
    """The runs of a sweep, in the order of the combinations; the last axis turns fastest."""

    def __init__(self, found: Found) -> None:
        self.found = found

    def __repr__(self) -> str:
        return f"<sweep of {self.found.wanted.scenario.name!r}: {len(self)} runs, {len(self) - self.found.ran} failed>"

    def __len__(self) -> int:
        return len(self.found.rows)

    @property
    def units(self) -> dict[str, str]:
        """The unit of each column that has one: SI, gains as they were given."""
        wanted = self.found.wanted
        of_axes = {axis.name: axis.si_unit or axis.unit for axis in wanted.axes}
        return of_axes | {asked.words: asked.unit for asked in wanted.measures}

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """One array per axis and metric, NaN where a run has no such number; `reason` why a run failed, or ""."""
        wanted, rows = self.found.wanted, self.found.rows
        found: dict[str, NDArray[Any]] = {}
        for number, axis in enumerate(wanted.axes):
            values = np.array(axis.texts if axis.si is None else axis.si)
            found[axis.name] = values[[row.places[number] for row in rows]]
        for column, asked in enumerate(wanted.measures):
            values = [np.nan if row.values[column] is None else row.values[column] for row in rows]
            found[asked.words] = np.array(values, dtype=float)
        if wanted.judge:
            found["passed"] = np.array([not row.reason and not row.failed for row in rows])
        return found | {"reason": np.array([row.reason for row in rows])}

    def best(self, metric: str) -> dict[str, Any]:
        """The run with the smallest value of a metric, column by column. Raises UsageError where none has a value."""
        words = [asked.words for asked in self.found.wanted.measures]
        index = self.found.best(words.index(metric)) if metric in words else None
        if index is None:
            raise UsageError(f"no run has a {metric!r}; the sweep has {', '.join(map(repr, words))}")
        return {name: values[index].item() for name, values in self.columns.items()}

    def frame(self, library: Literal["pandas", "polars"] = "pandas") -> Any:
        """All columns as a frame of pandas or polars. Raises UsageError where the library is not installed."""
        return frames(library).DataFrame(self.columns)

    def save(self, path: str | Path) -> Path:
        """Write the CSV of `hydrotwin sweep`."""
        return write_csv(self.found, Path(path))

    def plain(self) -> dict[str, Any]:
        """The JSON of `hydrotwin sweep`."""
        return plain(self.found)
