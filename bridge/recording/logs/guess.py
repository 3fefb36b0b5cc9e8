"""A map for a log, proposed from names, units and values: TOML to be edited, saying how sure each line is."""

import json
from collections.abc import Iterator
from pathlib import Path
from shlex import quote
from typing import NamedTuple

import numpy as np

from bridge.errors import UsageError, visible
from bridge.recording.logs.clock import clock_of
from bridge.recording.logs.formats import read_log
from bridge.recording.logs.guessed_scale import command_scale, converter_of
from bridge.recording.logs.guessed_time import GuessedTime, guessed_time
from bridge.recording.logs.headers import factor
from bridge.recording.logs.kinds import Sure, candidates
from bridge.recording.logs.map import COMMAND, Time
from bridge.recording.logs.packed import head, name_of
from bridge.recording.logs.reading import Reading
from bridge.recording.logs.table import Column, Table
from bridge.scenario import check
from bridge.scenario.channels import known
from bridge.scenario.files import plain
from twin.topology import CHANNELS

STEP = 50e-6  # [s]: a grid is whole steps of the simulation
PRESSURES = ("p_p", "p_t", "p1", "p2", "p3")
SIDES = {"p2": "A", "p3": "B"}
SHARES = (COMMAND, "spool")  # of the valve's travel
UNITS = {"velocity": "m/s", "acceleration": "m/s^2", "force": "N"}  # where nothing is said
MOST_BAR = 2000.0  # what goes further is in Pa; assumed
LONGEST_METRES = 3.0  # what goes further is not in metres; assumed
MOST_EXTRA = 50
MOST_COUNTS = 2.0**32  # of a converter or a counter of 32 bits
MCAP = b"\x89MCAP0\r\n"
NOT_MONOTONE = 0.5  # of correlation: below it nothing is said of signs; assumed


class Guess(NamedTuple):
    """A column taken for a signal."""

    column: str  # its key in the log
    sure: Sure
    why: str


class Proposal(NamedTuple):
    """A map in TOML, and how sure each of its signals is."""

    text: str
    signals: dict[str, Guess]


def guessed_map(path: Path, rig: str) -> Proposal:
    """Propose a map for a log of the drive of a scenario. Raises UsageError for what is not a log."""
    _refuse_own(path)
    valid = {COMMAND, "reference", *CHANNELS, *known(check(plain(rig), rig))}
    table = read_log(path, Reading())
    time = guessed_time(table)
    if time is None:
        raise UsageError(
            f"{path}: no column looks like times; write a map with [time] column, or [time] step: docs/import.md"
        )
    columns = {name: one for name, one in table.columns.items() if name != time.column and one.texts is None}
    columns = {name: one for name, one in columns.items() if np.isfinite(one.values).any() and one.unit != "ns"}
    signals = _assigned({name: one for name, one in columns.items() if not _is_identity(one)}, valid)
    text = "\n".join(_lines(path, table, rig, time, signals, columns)) + "\n"
    return Proposal(text, signals)


def _refuse_own(path: Path) -> None:
    """Raises UsageError for a recording of ours."""
    from bridge.recording.reader import read

    if path.is_file() and head(path, len(MCAP)) == MCAP and "scenario" in read(path, (), True).metadata.get("run", {}):
        raise UsageError(f"{path}: is a recording of hydrotwin; it needs no import, every verb takes it as it is")


def _assigned(columns: dict[str, Column], valid: set[str]) -> dict[str, Guess]:
    """Each signal its likeliest column, each column one signal: the surest first, then in the order of the file."""
    offers = [
        (sure if _moves(column) else Sure.UNSURE, -place, -rank, signal, name, why)
        for place, (name, column) in enumerate(columns.items())
        for rank, (signal, sure, why) in enumerate(candidates(column))
        if signal in valid
    ]
    found: dict[str, Guess] = {}
    for sure, _, _, signal, name, why in sorted(offers, reverse=True):
        if signal not in found and name not in {guess.column for guess in found.values()}:
            found[signal] = Guess(name, sure, why)
    return found


def _is_identity(column: Column) -> bool:
    """Are its whole numbers larger than any count of a sensor: identities, hashes, stamps of an epoch?"""
    return column.whole is not None and float(np.abs(column.values).max()) > MOST_COUNTS


def _moves(column: Column) -> bool:
    """Is it more than one value all the time?"""
    return bool(np.nanmax(column.values) > np.nanmin(column.values))


def _lines(
    path: Path, table: Table, rig: str, time: GuessedTime, signals: dict[str, Guess], columns: dict[str, Column]
) -> Iterator[str]:
    yield f"# A guess at the map of {visible(name_of(path))} ({table.form}): every line says how sure it is."
    yield f"# Look at it, correct it, then: hydrotwin import {quote(visible(str(path)))} --map THIS.toml -o run.mcap"
    yield f"rig = {_quoted(rig)}  # unsure: a log does not say which drive it is of; a scenario or a file of yours"
    period = round(max(1.0, time.interval / STEP)) * STEP
    yield f'period = "{period * 1e3:g} ms"  # rows are usually {time.interval * 1e3:.6g} ms apart'
    yield ""
    yield from _time(time, table)
    turned = _turned(table, time, signals)
    for signal, guess in signals.items():
        yield ""
        yield f"[signal.{signal}]  # {guess.sure.word}: {guess.why}, {_range(columns[guess.column])}"
        yield f"column = {_quoted(guess.column)}"
        yield from _how(signal, columns[guess.column], turned)
    yield from _extras(columns, signals)


def _time(time: GuessedTime, table: Table) -> Iterator[str]:
    yield f"[time]  # {time.sure.word}: {time.why}"
    if time.column:
        yield f"column = {_quoted(time.column)}"
        yield f"unit = {_quoted(time.unit)}"
    elif any(name.endswith("header.stamp") for name in table.columns):
        yield '# column = "header.stamp"  # the stamps in the messages instead of the times at which they were logged'
    if time.wrap:
        yield f"wrap = {time.wrap!r}  # unsure: the value after the last one"


def _how(signal: str, column: Column, turned: float) -> Iterator[str]:
    if signal in SHARES:
        scale = command_scale(column)
        first, *others = scale.lines or (f'unit = "{column.unit}"',)
        yield f"{first}  # {scale.sure.word}: {scale.why}"
        yield from others
        if signal == COMMAND:
            yield from _sign(turned)
            yield 'method = "previous"  # held from row to row'
        return
    yield from _unit(signal, column)
    if signal in PRESSURES and not column.unit.endswith("abs"):
        yield '# taken as gauge; an absolute one has unit = "bar abs" and its like'
    if signal in SIDES:
        yield f"# {signal} is the chamber of port {SIDES[signal]}; unsure: a log does not say whether cap or rod side"
    if signal == "position":
        yield "# must grow as port A drives the piston; if not: sign = -1, and an offset"
    converter = converter_of(column.values) if column.unit and not column.unit.endswith("abs") else None
    if converter is not None:
        low, top = (f"{end:g} {column.unit}" for end in (converter.low, converter.top))
        yield f'range = ["{low}", "{top}"]  # unsure: its steps are those of such a converter;'
        yield f"bits = {converter.bits}  # without these two the noise is estimated"
        yield 'noise = "0.5 LSB"  # unsure: usual'


def _unit(signal: str, column: Column) -> Iterator[str]:
    if column.unit:
        yield f'unit = "{column.unit}"  # sure: its head says so'
        return
    small = float(np.nanmax(np.abs(column.values))) < LONGEST_METRES
    unit = UNITS.get(signal, "m" if small else "mm")
    if signal in PRESSURES:
        unit = "bar" if float(np.nanmax(np.abs(column.values))) < MOST_BAR else "Pa"
    yield f'unit = "{unit}"  # unsure: no unit in its head'


def _turned(table: Table, time: GuessedTime, signals: dict[str, Guess]) -> float:
    """How the piston's speed goes with the command: correlation; 0 where it cannot be said."""
    if COMMAND not in signals or "position" not in signals:
        return 0.0
    command, position = (table.columns[signals[name].column] for name in (COMMAND, "position"))
    if len(command.values) != len(position.values) or len(position.values) < 50:
        return 0.0
    try:
        clock = clock_of(
            table, position, Time(column=time.column, unit=time.unit, wrap=time.wrap), len(position.values), ""
        )
    except UsageError:
        return 0.0
    away = max(1, round(0.01 / max(1e-6, float(np.median(np.diff(clock.seconds))))))  # 10 ms: above a sensor's noise
    moved = position.values[clock.order][away:] - position.values[clock.order][:-away]
    sent = command.values[clock.order][:-away]
    rows = np.isfinite(moved) & np.isfinite(sent)
    if rows.sum() < 50 or not np.ptp(moved[rows]) or not np.ptp(sent[rows]):
        return 0.0
    return float(np.corrcoef(moved[rows], sent[rows])[0, 1])


def _sign(turned: float) -> Iterator[str]:
    if turned < -NOT_MONOTONE:
        yield f"sign = -1  # likely: the position falls with it (correlation {turned:.2f}); or its own sign is -1"
    elif turned > NOT_MONOTONE:
        yield f"# sign = 1: likely, the position grows with it (correlation {turned:.2f})"
    else:
        yield "# sign = 1: unsure, the position does not say"


def _extras(columns: dict[str, Column], signals: dict[str, Guess]) -> Iterator[str]:
    """What is none of our signals, kept under its own name."""
    taken, used = {guess.column for guess in signals.values()}, set()
    for name, column in [(n, c) for n, c in columns.items() if n not in taken][:MOST_EXTRA]:
        if column.words is not None:
            yield f"\n# not taken: {visible(name)} holds text, such as {visible(column.words.first)[:40]!r}"
            continue
        own = "".join(c if c.isascii() and c.isalnum() else "_" for c in column.name).strip("_")[:60]
        own = own if own[:1].isalpha() else f"c_{own}".rstrip("_")
        while own in used:
            own += "_2"
        used.add(own)
        yield f"\n[extra.{own}]  # none of our signals by its name, {_range(column)}"
        yield f"column = {_quoted(name)}"


def _range(column: Column) -> str:
    low, high = float(np.nanmin(column.values)), float(np.nanmax(column.values))
    shown = f"{low:.5g} to {high:.5g} {column.unit}".rstrip()
    return shown if not column.unit or factor(column.unit)[0] else shown.replace("  ", " ")


def _quoted(text: str) -> str:
    """A string of TOML."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
