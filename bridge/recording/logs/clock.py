"""When the rows of a log were taken: seconds from the first, whatever the file counts in, sorted, each instant once."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError, nearest
from bridge.recording.logs.dates import nanoseconds_of
from bridge.recording.logs.map import Time
from bridge.recording.logs.table import Column, Table, numbers

NS = 1_000_000_000
UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "day": 86400.0}  # [s]
TEXT = "text"
FEW_BACK = 0.02  # share of the rows that may stand behind later ones; more of them, and the order is not that of time
FEWEST = 10  # rows: of fewer a step back of half of the span says nothing
LONGEST_LOG = 366.0 * 86400.0  # [s]


Ticks = tuple[NDArray[np.float64], float, int, str]


class Clock(NamedTuple):
    """Rows in the order of time."""

    seconds: NDArray[np.float64]  # rising, from the first row's 0
    order: NDArray[np.int64]  # the file's row of each
    begin: int  # [ns] time of the first, from whatever the file counts from
    origin: str  # the file's first time, as it has it
    duplicates: int  # rows left out, since a later one has the same time
    moved: int  # rows that stood behind later ones
    wraps: int  # how often the counter began again
    untimed: int  # rows without a time, left out


def clock_of(table: Table, column: Column, time: Time, rows: int, who: str) -> Clock:
    """The clock of a column's rows. Raises UsageError for times that cannot be one."""
    ticks, scale, zero, origin = _ticks(table, column, time, rows, who)
    if len(ticks) != rows:
        raise UsageError(
            f"{who}: column {column.name!r} has {rows} rows, and its times {len(ticks)}: name times that belong to it"
        )
    known = np.flatnonzero(np.isfinite(ticks))
    if len(known) < 2:
        raise UsageError(f"{who}: the log has {len(known)} rows with a time; a recording needs two")
    raw, wraps = _unwrapped(ticks[known], time.wrap)
    raw = raw * scale
    moved = int(np.sum(raw < np.maximum.accumulate(raw)))
    _refuse_back(raw, moved, time, scale, known, who)
    order = np.argsort(raw, kind="stable")
    seconds = raw[order]
    last = np.append(np.diff(seconds) > 0.0, True)  # of equal times the row that was written last
    earliest = float(seconds[0])
    seconds, order = seconds[last] - earliest, known[order][last]
    if not seconds[-1] <= LONGEST_LOG:
        raise UsageError(
            f"{who}: the times reach over {seconds[-1]:g} s; a log may have a year: is the unit of time right?"
        )
    duplicates = int(np.sum(~last))
    return Clock(seconds, order, zero + round(earliest * NS), origin, duplicates, moved, wraps, rows - len(known))


def _ticks(table: Table, column: Column, time: Time, rows: int, who: str) -> Ticks:
    """Times as numbers from the first one's 0, what one of them is in seconds, the first [ns], and it in words."""
    if time.column:
        return _from_column(_time_column(table, column, time, who), time, who)
    if column.clock is not None:
        begin = int(column.clock[0]) if len(column.clock) else 0
        return (column.clock - begin).astype(np.float64), 1.0 / NS, begin, f"{begin} ns"
    if time.step > 0.0:
        return np.arange(float(rows)), time.step, 0, "row 1"
    raise UsageError(f"{who}: the file has no times of its own: say [time] column, or [time] step of its rows")


def _time_column(table: Table, column: Column, time: Time, who: str) -> Column:
    """The column of times: of a group of its own the one in the same group."""
    group, _, _ = column.name.rpartition(".")
    own = f"{group}.{time.column}"
    while group and own not in table.columns:
        group, _, _ = group.rpartition(".")
        own = f"{group}.{time.column}"
    return table.columns[own] if own in table.columns else table.column(time.column, f"{who}: [time] column")


def _from_column(column: Column, time: Time, who: str) -> Ticks:
    who = f"{who}: [time] column {column.name!r}"
    if column.texts is not None and time.unit in ("", TEXT):
        stamps = nanoseconds_of(column.texts, time.format, who)
        known = stamps[stamps != np.iinfo(np.int64).min]
        begin = int(known[0]) if len(known) else 0
        ticks = np.where(stamps == np.iinfo(np.int64).min, np.nan, (stamps - begin).astype(np.float64))
        return ticks, 1.0 / NS, begin, next((text for text in column.texts if text.strip()), "")
    if column.clock is not None and column.whole is None and np.isnan(column.values).all():
        raise UsageError(f"{who} holds no number")
    unit = time.unit or column.unit
    if unit not in UNITS:
        how = f"{unit!r} is not a unit of time" if unit else "has no unit"
        raise UsageError(f"{who} {how}: say [time] unit{nearest(unit, UNITS) if unit else ', such as s or ms'}")
    values = numbers(column, who)
    if column.whole is not None:  # whole nanoseconds of an epoch do not fit into a float
        zero = int(column.whole[0])
        return (column.whole - zero).astype(np.float64), UNITS[unit], round(zero * UNITS[unit] * NS), f"{zero} {unit}"
    first = next((value for value in values.tolist() if math.isfinite(value)), 0.0)
    return values - first, UNITS[unit], round(first * UNITS[unit] * NS), f"{first!r} {unit}"


def _unwrapped(ticks: NDArray[np.float64], wrap: float) -> tuple[NDArray[np.float64], int]:
    """A counter that begins again at `wrap`, counted on."""
    if not wrap:
        return ticks, 0
    steps = np.diff(ticks)
    turns = np.concatenate([[0.0], np.cumsum(np.round(-steps / wrap))])
    return ticks + turns * wrap, int(np.sum(np.diff(turns) > 0))


def _refuse_back(
    raw: NDArray[np.float64], moved: int, time: Time, scale: float, rows: NDArray[np.int64], who: str
) -> None:
    steps, behind = np.diff(raw), np.maximum.accumulate(raw) - raw
    far = behind.max() > 0.5 * np.ptp(raw) and len(raw) > FEWEST
    if time.sort or (not far and moved <= max(2, FEW_BACK * len(raw))):
        return
    at = int(np.argmin(steps))
    raise UsageError(
        f"{who}: time goes back by {-steps[at] / scale:g} at row {rows[at + 1] + 1}, and {moved} rows are earlier than "
        "one before them: where a counter begins again say [time] wrap, the value after its last one; "
        "where the rows stand in no order say [time] sort = true"
    )
