"""Which column of a log are its times, in which unit, and where a counter begins again."""

from typing import NamedTuple

import numpy as np

from bridge.errors import UsageError
from bridge.recording.logs.clock import FEW_BACK, UNITS
from bridge.recording.logs.dates import NONE, nanoseconds_of
from bridge.recording.logs.kinds import Sure, parts_of
from bridge.recording.logs.table import Column, Table

WORDS = frozenset(("time", "zeit", "timestamp", "stamp", "date", "datum", "uhrzeit", "clock", "tick", "ticks"))
WORDS |= {"t", "ts", "sec", "second", "seconds", "ms"}
ROUND = [2.0**bits for bits in (8, 10, 12, 14, 16, 20, 24, 31, 32)] + [10.0**n for n in range(2, 10)]
USUAL = (2e-5, 0.2)  # [s]: between rows of logs of drives; assumed


class GuessedTime(NamedTuple):
    """What a map would say of the times."""

    column: str  # "": those that the file has beside its columns
    unit: str
    wrap: float
    sure: Sure
    why: str
    interval: float  # [s]; 0: not known


def guessed_time(table: Table) -> GuessedTime | None:
    """The times of a log; None where no column looks like them."""
    clocks = [column.clock for column in table.columns.values() if column.clock is not None]
    if clocks:
        longest = max(clocks, key=len)
        steps = np.diff(np.sort(longest))
        step = float(np.median(steps)) * 1e-9 if len(steps) else 0.0
        return GuessedTime("", "", 0.0, Sure.SURE, "the file has times of its own", step)
    found = [(_score(column), name, column) for name, column in table.columns.items()]
    found = [entry for entry in found if entry[0] > 0]
    if not found:
        return None
    score, name, column = max(found, key=lambda entry: entry[0])
    return _of(name, column, score)


def _score(column: Column) -> int:
    """0: cannot be; a name counts more than a course, and a unit of time more than both."""
    named = bool(WORDS & set(parts_of(column.name)))
    if column.texts is not None:
        return 4 + named if _dates(column) else 0
    values = column.values[np.isfinite(column.values)]
    if len(values) < 2:
        return 0
    steps = np.diff(values)
    forward = float(np.mean(steps > 0.0))
    if forward < 1.0 - 5.0 * FEW_BACK:
        return 0
    even = len(steps) < 3 or float(np.median(np.abs(steps - np.median(steps)))) <= 0.1 * float(np.median(steps))
    return 1 + even + 2 * named + 3 * (column.unit in UNITS)


def _dates(column: Column) -> bool:
    try:
        return bool((nanoseconds_of((column.texts or [])[:50], "", "") != NONE).any())
    except UsageError:
        return False


def _of(name: str, column: Column, score: int) -> GuessedTime:
    if column.texts is not None:
        stamps = nanoseconds_of([text for text in column.texts[:1000] if text.strip()], "", name)
        return GuessedTime(name, "text", 0.0, Sure.SURE, "dates and times", float(np.median(np.diff(stamps))) * 1e-9)
    values = column.values[np.isfinite(column.values)]
    steps = np.diff(values)
    step = float(np.median(steps))
    unit, sure, why = _unit(column, step)
    wrap = 0.0
    if (back := float(-steps.min())) > 0.5 * float(np.ptp(values)) and len(values) > 10:
        top = float(values.max())
        wrap = next((end for end in sorted(ROUND) if top < end <= 1.02 * (top + step)), top + step)
        why += f"; it goes back by {back:g}, so a counter begins again"
    return GuessedTime(name, unit, wrap, sure if score > 3 else Sure.UNSURE, why, step * UNITS[unit])


def _unit(column: Column, step: float) -> tuple[str, Sure, str]:
    if column.unit in UNITS:
        return column.unit, Sure.SURE, f"its head says {column.unit}"
    fitting = [unit for unit in ("s", "ms", "us", "ns") if USUAL[0] <= step * UNITS[unit] <= USUAL[1]]
    unit = fitting[0] if fitting else "s"
    return unit, Sure.LIKELY if len(fitting) == 1 else Sure.UNSURE, f"no unit in its head; {step:g} {unit} between rows"
