"""What the piston should do: a reference as a function of time.

Every reference is right-continuous: at a corner the new value and the new slope hold. Times in seconds since the
start of the run, positions in metres (for an open-loop law: spool reference, -1..1).
"""

import csv
import math
from bisect import bisect_right
from functools import singledispatch
from typing import NamedTuple

SHOWN = 40  # characters of what a message quotes
HEADER = ["time_s", "position_m"]
HALF_NS = 0.5e-9  # stamps are whole nanoseconds: two times nearer than this are one stamp, rounded twice


class Target(NamedTuple):
    """What is wanted now. An open-loop law takes `position` as the spool reference itself, -1..1."""

    position: float  # [m]
    velocity: float  # [m/s], slope of the position to the right of now


class Constant(NamedTuple):
    value: float  # [m]


class Step(NamedTuple):
    start: float  # [m], before `at`
    end: float  # [m], from `at` on
    at: float  # [s]


class Square(NamedTuple):
    mean: float  # [m], held before `at`
    amplitude: float  # [m], added in the first half period, subtracted in the second
    period: float  # [s], > 0
    at: float  # [s]


class Ramp(NamedTuple):
    start: float  # [m], held before `at`
    end: float  # [m], held once reached; above or below the start
    at: float  # [s]
    rate: float  # [m/s], > 0


class Sine(NamedTuple):
    mean: float  # [m], held before `at`
    amplitude: float  # [m]
    frequency: float  # [Hz]
    at: float  # [s], phase 0 here


class Chirp(NamedTuple):
    mean: float  # [m], held before `at` and after the sweep
    amplitude: float  # [m]
    start_frequency: float  # [Hz]
    end_frequency: float  # [Hz], reached linearly in time
    at: float  # [s], phase 0 here
    duration: float  # [s], > 0


class Table(NamedTuple):
    times: tuple[float, ...]  # [s], increasing, at least two
    values: tuple[float, ...]  # [m], linear between the points, the first and the last held outside


Reference = Constant | Step | Square | Ramp | Sine | Chirp | Table


@singledispatch
def evaluate(reference: Reference, t: float) -> Target:
    """Target at t [s]; TypeError for what is not a reference."""
    raise TypeError(f"{reference!r} at {t} s is not a reference; use one of {Reference}")


@evaluate.register
def _(reference: Constant, t: float) -> Target:
    return Target(reference.value, 0.0)


@evaluate.register
def _(reference: Step, t: float) -> Target:
    return Target(reference.start if _since(reference.at, t) < 0.0 else reference.end, 0.0)


@evaluate.register
def _(reference: Square, t: float) -> Target:
    since = _since(reference.at, t)
    if since < 0.0:
        return Target(reference.mean, 0.0)
    half_periods = math.floor((since + HALF_NS) / (0.5 * reference.period))
    return Target(reference.mean + (-reference.amplitude if half_periods % 2 else reference.amplitude), 0.0)


@evaluate.register
def _(reference: Ramp, t: float) -> Target:
    since = _since(reference.at, t)
    way = reference.end - reference.start
    if since < 0.0:
        return Target(reference.start, 0.0)
    if reference.rate * (since + HALF_NS) >= abs(way):
        return Target(reference.end, 0.0)
    velocity = math.copysign(reference.rate, way)
    return Target(reference.start + velocity * since, velocity)


@evaluate.register
def _(reference: Sine, t: float) -> Target:
    since = _since(reference.at, t)
    if since < 0.0:
        return Target(reference.mean, 0.0)
    omega = 2.0 * math.pi * reference.frequency
    return _wave(reference.mean, reference.amplitude, omega * since, omega)


@evaluate.register
def _(reference: Chirp, t: float) -> Target:
    since = _since(reference.at, t)
    if since < 0.0 or since + HALF_NS >= reference.duration:
        return Target(reference.mean, 0.0)
    slope = (reference.end_frequency - reference.start_frequency) / reference.duration
    turns = (reference.start_frequency + 0.5 * slope * since) * since
    frequency = reference.start_frequency + slope * since
    return _wave(reference.mean, reference.amplitude, 2.0 * math.pi * turns, 2.0 * math.pi * frequency)


@evaluate.register
def _(reference: Table, t: float) -> Target:
    times, values = reference
    right = bisect_right(times, t)
    if right == 0 or right == len(times):
        return Target(values[0] if right == 0 else values[-1], 0.0)
    left = right - 1
    velocity = (values[right] - values[left]) / (times[right] - times[left])
    return Target(values[left] + velocity * (t - times[left]), velocity)


def table_from_csv(text: str) -> Table:
    """Table from the text of a CSV file: time [s], position [m], the line `time_s,position_m` optional at its top.

    Raises ValueError, with line and value, for what is not two finite numbers, times that do not increase, and
    fewer than two rows.
    """
    rows: list[tuple[float, float]] = []
    for line, cells in _filled_lines(text):
        time, position = _numbers(cells, line)
        if rows and time <= rows[-1][0]:
            raise ValueError(f"line {line}: time {time} s is not after {rows[-1][0]} s; times must increase")
        rows.append((time, position))
    if len(rows) < 2:
        raise ValueError(f"{len(rows)} rows of numbers; a table needs at least 2, each '{','.join(HEADER)}'")
    return Table(tuple(time for time, _ in rows), tuple(position for _, position in rows))


def _filled_lines(text: str) -> list[tuple[int, list[str]]]:
    """Line number and cells of every line that holds something, without the header.

    Between them stand commas; or semicolons or tabs, and then a decimal comma is one.
    """
    separator = next((mark for mark in (";", "\t") if mark in text), ",")
    text = text if separator == "," else text.replace(",", ".")
    reader = csv.reader(text.removeprefix("\ufeff").splitlines(), delimiter=separator)  # spreadsheets write that mark
    try:
        lines = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    except csv.Error as error:
        raise ValueError(f"line {reader.line_num}: {error}") from None
    filled = [(line, cells) for line, cells in lines if any(cells)]
    return filled[1:] if filled and filled[0][1] == HEADER else filled


def _numbers(cells: list[str], line: int) -> tuple[float, float]:
    if len(cells) != 2:
        raise ValueError(
            f"line {line}: {len(cells)} columns in {','.join(cells)[:SHOWN]!r}; expected 2: {','.join(HEADER)}"
        )
    return _number(cells[0], HEADER[0], line), _number(cells[1], HEADER[1], line)


def _number(cell: str, name: str, line: int) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"line {line}: {name} is {cell[:SHOWN]!r}; expected a finite number")
    return value


def _since(at: float, t: float) -> float:
    since = t - at
    return 0.0 if abs(since) < HALF_NS else since


def _wave(mean: float, amplitude: float, phase: float, omega: float) -> Target:
    return Target(mean + amplitude * math.sin(phase), amplitude * omega * math.cos(phase))
