"""How two runs differ: their metrics, their signals, their parameters."""

from typing import Any, NamedTuple

import numpy as np

from bridge.report.subject import Run
from bridge.scenario.bands import (
    METRICS,
    SHOWN,
    SIGNALS,
    value_with_unit,
)
from bridge.scenario.describe import values_of


class Difference(NamedTuple):
    """One signal of one run less that of another, at the instants that both have."""

    signal: str
    unit: str  # shown
    greatest: float
    at: float  # [s]
    rms: float
    first: float | None  # [s] of the first difference; None where there is none


def signal_differences(run: Run, other: Run) -> list[Difference]:
    """Every true signal that both have, those that differ most in the first place of nothing: in the file's order."""
    _, mine, theirs = np.intersect1d(run.state["stamp"], other.state["stamp"], return_indices=True)
    if not len(mine):
        return []
    time = run.time[mine]
    return [
        _difference(name, run.state[name][mine], other.state[name][theirs], time)
        for name in SIGNALS
        if name in run.state and name in other.state
    ]


def _difference(name: str, mine: Any, theirs: Any, time: Any) -> Difference:
    factor, unit = SHOWN.get(SIGNALS[name], (1.0, SIGNALS[name]))
    apart = np.abs(mine - theirs) * factor
    most = int(np.argmax(apart))
    differs = np.flatnonzero(apart > 0.0)
    first = float(time[differs[0]]) if len(differs) else None
    return Difference(name, unit, float(apart[most]), float(time[most]), float(np.sqrt(np.mean(apart**2))), first)


def metric_rows(runs: list[Run]) -> list[tuple[str, ...]]:
    """Metric, and what each run came to; of two runs also by how much they differ."""
    rows = []
    for name, shown in METRICS.items():
        values = [run.summary.get("metrics", {}).get(name) for run in runs]
        if all(value is None for value in values):
            continue
        apart = [_apart(name, *values)] if len(values) == 2 else []
        rows.append((shown.words, *(value_with_unit(name, value) for value in values), *apart))
    return rows


def _apart(name: str, mine: float | None, theirs: float | None) -> str:
    if mine is None or theirs is None:
        return "-"
    return value_with_unit(name, theirs - mine) if theirs != mine else "same"


def parameter_rows(runs: list[Run]) -> list[tuple[str, ...]]:
    """Parameters that are not the same in all runs: of the rig, and of everything else in their scenarios."""
    rigs = [{value.name: value.value for value in values_of(run.scenario)} for run in runs]
    rest = [dict(_flat(run.scenario.model_dump(mode="json", exclude={"rig", "expect", "title"}))) for run in runs]
    rows = []
    for found in (rest, rigs):
        for name in dict.fromkeys(name for each in found for name in each):
            values = [each.get(name, "-") for each in found]
            if len(set(values)) > 1:
                rows.append((name, *values))
    return rows


def scenario_rows(run: Run) -> list[tuple[str, str]]:
    """All that a scenario says beside the rig, in SI."""
    return list(_flat(run.scenario.model_dump(mode="json", exclude={"rig", "expect", "title"})))


def _flat(value: Any, name: str = "") -> Any:
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from _flat(entry, f"{name}.{key}" if name else key)
    else:
        yield name, f"{value:g}" if isinstance(value, float) else str(value)
