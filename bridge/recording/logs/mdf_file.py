"""MDF, the form of measurement systems: channels in groups, each group with times of its own. Needs asammdf."""

import gc
import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from bridge.errors import UsageError
from bridge.recording.logs.columns_of import column
from bridge.recording.logs.limits import MOST_CELLS, refuse_large, size_of
from bridge.recording.logs.reading import Reading
from bridge.recording.logs.table import Column, Table

NS = 1_000_000_000
FORMULA = 3  # kind of conversion (ASAM MDF 4, conversion type "algebraic")


def read_mdf(path: Path, reading: Reading) -> Table:
    """The channels of an MDF file. Raises UsageError for one that cannot be read, and without asammdf."""
    try:
        from asammdf import MDF
    except ImportError:
        raise UsageError(f"{path}: is MDF, which needs asammdf: pip install 'hydrotwin[logs]'") from None
    size_of(path)
    logging.getLogger("asammdf").setLevel(logging.CRITICAL)
    with _quiet():
        found, words = _read(MDF, path)
    if isinstance(words, UsageError):
        raise words
    if found is None:
        raise UsageError(f"{path}: is MDF that cannot be read ({words:.100})")
    if not found.columns:
        raise UsageError(f"{path}: holds no channel of numbers")
    return found


def _read(kind: Any, path: Path) -> tuple[Table | None, Any]:
    """The table, or why there is none: asammdf raises errors of many kinds for damaged bytes."""
    try:
        with kind(path) as file:
            _refuse_large(path, file)
            found, formulas = _columns(file)
            version = file.version
    except UsageError as error:
        return None, error
    except Exception as error:
        return None, " ".join(str(error).split())
    left = ", ".join(formulas[:5])
    notes = (f"left out, since a formula converts them: {left}; export them converted",) if formulas else ()
    return Table(f"MDF {version}", found, notes), ""


@contextmanager
def _quiet() -> Iterator[None]:
    """What asammdf has opened half complains on its way out, past every handler, with a traceback."""
    hook = sys.unraisablehook
    sys.unraisablehook = lambda _: None
    try:
        yield
    finally:
        gc.collect()
        sys.unraisablehook = hook


def _refuse_large(path: Path, file: Any) -> None:
    """Raises UsageError by what the file says of itself, before anything is unpacked."""
    sizes = [(int(group.channel_group.cycles_nr), len(group.channels)) for group in file.groups]
    for rows, columns in sizes:
        refuse_large(path, rows, columns)
    if sum(rows * columns for rows, columns in sizes) > MOST_CELLS:
        raise UsageError(f"{path}: has more than {MOST_CELLS} numbers; a log may have as many: leave channels out")


def _columns(file: Any) -> tuple[dict[str, Column], list[str]]:
    """By name, in a group beyond the first that has the name by GROUP.NAME; and what a formula converts."""
    found: dict[str, Column] = {}
    formulas: list[str] = []
    for number, place, channel in _channels(file):
        if getattr(channel.conversion, "conversion_type", 0) == FORMULA:
            formulas.append(channel.name)
            continue
        signal = file.get(group=number, index=place)
        values = np.asarray(signal.samples)
        if values.dtype.kind in "iuf" and getattr(signal, "invalidation_bits", None) is not None:
            values = np.where(np.asarray(signal.invalidation_bits, bool), np.nan, values.astype(np.float64))
        clock = np.round(np.asarray(signal.timestamps, np.float64) * NS).astype(np.int64)
        made = column(channel.name, values, str(signal.unit or ""), clock)
        key = channel.name if channel.name not in found else f"group{number + 1}.{channel.name}"
        if made is not None and len(clock) == len(made.values):
            found[key] = made._replace(name=key)
    return found, formulas


def _channels(file: Any) -> Iterator[tuple[int, int, Any]]:
    """Group, place in it and channel, the times themselves left out."""
    for number, group in enumerate(file.groups):
        master = file.masters_db.get(number)
        yield from ((number, place, channel) for place, channel in enumerate(group.channels) if place != master)
