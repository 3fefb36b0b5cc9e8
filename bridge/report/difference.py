"""How two runs differ: their metrics, their signals, their parameters."""

from typing import Any

from bridge.recording.compare import Difference, difference, without_missing
from bridge.recording.signals import Signal, signals_of
from bridge.recording.summary import plain_metrics
from bridge.report.subject import Run
from bridge.scenario.bands import (
    METRICS,
    SIGNALS,
    value_with_unit,
)
from bridge.scenario.describe import values_of
from bridge.scenario.units import shown
from bridge.wire.messages import CHANNELS_TOPIC


def signal_differences(run: Run, other: Run) -> list[Difference]:
    """Every signal both runs have, in file order, in the units people read."""
    shared = [name for name in SIGNALS if name in run.state and name in other.state]
    found = [difference(name, _signal(run, name), _signal(other, name), 0.0, partly=True) for name in shared]
    mine, theirs = (signals_of(each.recording, (CHANNELS_TOPIC, "signals")) for each in (run, other))
    pairs = [(_there(run, mine[name]), _there(other, theirs[name])) for name in mine if name in theirs]
    found += [difference(one.name, one, two, 0.0, partly=True) for one, two in pairs]
    return [_shown(each) for each in found if each.instants]


def _signal(run: Run, name: str) -> Signal:
    return _there(run, Signal(name, SIGNALS[name], run.state["stamp"], run.state[name]))


def _there(run: Run, signal: Signal) -> Signal:
    return without_missing(signal) if run.measured else signal


def _shown(found: Difference) -> Difference:
    factor, unit = shown(found.unit)
    return found._replace(unit=unit, greatest=found.greatest * factor, rms=found.rms * factor)


def metric_rows(runs: list[Run]) -> list[tuple[str, ...]]:
    """Metric, and what each run came to; of two runs also by how much they differ."""
    rows = []
    for name, metric in METRICS.items():
        values = [plain_metrics(run.summary.metrics).get(name) for run in runs]
        if all(value is None for value in values):
            continue
        apart = [_apart(name, *values)] if len(values) == 2 else []
        rows.append((metric.words, *(value_with_unit(name, value) for value in values), *apart))
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
    """All that a scenario says apart from the rig, in SI."""
    return list(_flat(run.scenario.model_dump(mode="json", exclude={"rig", "expect", "title"})))


def _flat(value: Any, name: str = "") -> Any:
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from _flat(entry, f"{name}.{key}" if name else key)
    else:
        yield name, f"{value:g}" if isinstance(value, float) else str(value)
