"""Columns of a log as signals of a drive on its grid: SI, our signs, and what was found missing on the way."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError
from bridge.recording.logs.clock import Clock, clock_of
from bridge.recording.logs.headers import factor
from bridge.recording.logs.limits import MOST_ROWS
from bridge.recording.logs.map import COMMAND, Extra, Map, Method, si_of
from bridge.recording.logs.resample import USUAL, Floats, holes, resampled, usual_interval
from bridge.recording.logs.table import Column, Table, numbers

MOST_HOLES = 20  # of a signal that are named


class Carried(NamedTuple):
    """A signal on the grid, and how it got there."""

    values: Floats  # SI; NaN: missing
    unit: str  # SI
    column: str
    taken_in: str  # unit that the column was taken in
    method: Method
    gap: float  # [s]: longer holes stay missing
    rows: int  # of the log, with a time
    empty: int  # of these without a number
    holes: list[tuple[float, float]]  # [s]: first and last missing instant of each, the first MOST_HOLES
    missing: int  # instants of the grid without a value


class Log(NamedTuple):
    """A log on its grid."""

    grid: NDArray[np.float64]  # [s]
    signals: dict[str, Carried]
    extras: dict[str, Carried]
    clock: Clock  # of the first signal
    interval: float  # [s], usual one between rows
    jitter: float  # [s], greatest deviation of an interval from the usual one, holes left out


def log_of(table: Table, mapped: Map, units: dict[str, str], period: float, who: str) -> Log:
    """All that a map names. units: SI unit of each signal. Raises UsageError with one sentence."""
    asked: dict[str, Extra] = {**mapped.signal, **mapped.extra}
    columns = {name: table.column(entry.column, f"{who}: {name}") for name, entry in asked.items()}
    clocks = _clocks(table, columns, mapped, who)
    begin = min(clock.begin for clock in clocks.values())
    shifts = {name: (clock.begin - begin) * 1e-9 for name, clock in clocks.items()}
    end = max(clock.seconds[-1] + shifts[name] for name, clock in clocks.items())
    grid = _grid(end, period, who)
    found = {
        name: _carried(columns[name], entry, clocks[name], shifts[name], grid, units.get(name), mapped, name, who)
        for name, entry in asked.items()
    }
    first = clocks[next(iter(mapped.signal))]
    interval = usual_interval(first.seconds)
    return Log(
        grid,
        {name: found[name] for name in mapped.signal},
        {name: found[name] for name in mapped.extra},
        first,
        interval,
        _jitter(first.seconds, interval),
    )


def _clocks(table: Table, columns: dict[str, Column], mapped: Map, who: str) -> dict[str, Clock]:
    """The clock of each signal; columns of one group share theirs."""
    made: dict[tuple[str, int, int], Clock] = {}
    found = {}
    for name, column in columns.items():
        key = (column.name.rpartition(".")[0], len(column.values), id(column.clock))
        if key not in made:
            made[key] = clock_of(table, column, mapped.time, len(column.values), who)
        found[name] = made[key]
    return found


def _grid(end: float, period: float, who: str) -> NDArray[np.float64]:
    number = int(np.floor(end / period + 1e-6))
    if number < 1:
        raise UsageError(f"{who}: the log is {end:g} s long, shorter than the grid's period of {period:g} s")
    if number > MOST_ROWS:
        raise UsageError(f"{who}: {end:g} s in periods of {period:g} s are {number} instants; at most {MOST_ROWS}")
    return np.arange(number + 1, dtype=np.float64) * period


def _jitter(seconds: Floats, interval: float) -> float:
    steps = np.diff(seconds)
    steps = steps[steps <= USUAL * interval]
    return float(np.abs(steps - interval).max()) if len(steps) else 0.0


def _carried(
    column: Column,
    entry: Extra,
    clock: Clock,
    shift: float,
    grid: Floats,
    unit: str | None,
    mapped: Map,
    name: str,
    who: str,
) -> Carried:
    si, taken_in, values = in_si(column, entry, unit, name, who)
    seconds, values = clock.seconds + shift - entry.delay, values[clock.order]
    method = entry.method or (Method.PREVIOUS if name == COMMAND else Method.LINEAR)
    gap = entry.gap or mapped.gap or USUAL * usual_interval(clock.seconds)
    found = resampled(grid, seconds, values, method, gap)
    if np.isnan(found).all():
        raise UsageError(f"{who}: {name}: column {column.name!r} holds no number at any instant of the grid")
    empty = int(np.sum(np.isnan(values)))
    missing = holes(grid, found)
    return Carried(
        found,
        si,
        column.name,
        taken_in,
        method,
        gap,
        len(values),
        empty,
        missing[:MOST_HOLES],
        int(np.sum(np.isnan(found))),
    )


def in_si(column: Column, entry: Extra, unit: str | None, name: str, who: str) -> tuple[str, str, Floats]:
    """SI unit, unit that the column was taken in, and the column's values in SI with our sign, in the file's order.

    unit: SI unit of the signal; None for one that keeps the column's own. Raises UsageError.
    """
    raw = numbers(column, f"{who}: {name}")
    if entry.wrap:
        raw = _counted_on(raw, entry.wrap)
    taken = column.unit if entry.known_unit is None else entry.known_unit
    base, known = factor(taken) if taken else ("", None)
    if entry.scale is None and unit is not None and base != unit:
        _refuse_unit(column, taken, unit, name, who)
    values = raw if known is None else raw * known.factor + known.offset
    si = base if unit is None else unit
    offset = si_of(entry.offset, si, f"{who}: {name}: offset")
    return si, taken, entry.sign * (1.0 if entry.scale is None else entry.scale) * values + offset


def _refuse_unit(column: Column, taken: str, unit: str, name: str, who: str) -> None:
    wanted = f"{name} is in {unit}" if unit else f"{name} is a share, 1 the whole"
    if not taken:
        raise UsageError(
            f"{who}: {name}: column {column.name!r} has no unit in its head, and {wanted}: say `unit`, or `scale`"
        )
    raise UsageError(
        f"{who}: {name}: column {column.name!r} is in {taken}, and {wanted}: say `scale`, {unit or 'share'} per "
        f"{factor(taken)[0]}, or another `unit`"
    )


def _counted_on(raw: Floats, wrap: float) -> Floats:
    """A counter that begins again at `wrap`, counted on in both directions; what is missing stays so."""
    known = np.isfinite(raw)
    found = raw.copy()
    found[known] = np.unwrap(raw[known], period=wrap)
    return found
