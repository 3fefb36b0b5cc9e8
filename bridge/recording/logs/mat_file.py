"""MATLAB files up to version 7: arrays, matrices, structures within one another; Simulink's logs are such structures.

Objects, functions and cells are left out: nothing in them is run.
"""

import math
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bridge.errors import UsageError
from bridge.recording.logs.columns_of import column, taken_apart
from bridge.recording.logs.limits import MOST_BYTES, MOST_COLUMNS, refuse_large, refuse_long, size_of
from bridge.recording.logs.packed import PIECE
from bridge.recording.logs.reading import Reading
from bridge.recording.logs.table import Column, Table

HEADER = 128  # bytes
TAG = struct.Struct("<II")  # type of an element, its bytes
COMPRESSED = 15
DEEPEST = 6  # structures within one another
UNITS = "units"  # a structure beside columns, with their units by the same names


def read_mat(path: Path, reading: Reading) -> Table:
    """The numbers of a MATLAB file. Raises UsageError for one that cannot be read."""
    from scipy.io import loadmat

    size_of(path)
    _refuse_unpacked(path)
    try:
        held = loadmat(path, squeeze_me=False, struct_as_record=True, verify_compressed_data_integrity=True)
    except Exception as error:  # of many kinds, from a reader of damaged bytes
        words = " ".join(str(error).split())
        raise UsageError(f"{path}: is not a MATLAB file that can be read ({words:.100}); save it with -v7") from None
    plain = {name: value for name, value in held.items() if not name.startswith("__")}
    return table_of(path, list(_parts(plain)), "MATLAB, version 5 to 7")


def table_of(path: Path, parts: list[tuple[str, Any, str]], form: str) -> Table:
    """A table of arrays by name, with their units. Raises UsageError where there are none."""
    found: dict[str, Column] = {}
    for name, values, unit in parts:
        for key, one in taken_apart(name, values):
            if len(found) < MOST_COLUMNS and (made := column(key, one, unit)) is not None:
                found[key] = made
    if not found:
        raise UsageError(f"{path}: holds no arrays of numbers; a log has one for the time and one for each signal")
    refuse_large(path, max(len(one.values) for one in found.values()), len(found))
    return Table(form, found)


def _parts(held: dict[str, Any], before: str = "", depth: int = 0) -> Iterator[Any]:
    """Name, array and unit of whatever has numbers."""
    own = _first(held[UNITS]) if UNITS in held else {}
    for name, value in held.items():
        if name == UNITS:
            continue
        found, key = np.asarray(value), f"{before}{name}"
        if found.dtype.names and depth < DEEPEST:
            for i, record in enumerate(found.reshape(-1)[:MOST_COLUMNS]):
                inner = {field: record[field] for field in found.dtype.names}
                place = key if found.size == 1 else f"{key}({i + 1})"
                yield from _parts(inner, f"{place}.", depth + 1)
        elif found.dtype.kind in "iufb":
            yield key, found, _word(own.get(name))
        elif found.dtype.kind == "U" and found.size > 1:
            yield key, found.reshape(-1), ""


def _first(value: Any) -> dict[str, Any]:
    found = np.asarray(value)
    if not found.dtype.names or found.size != 1:
        return {}
    record = found.reshape(-1)[0]
    return {name: record[name] for name in found.dtype.names}


def _word(value: Any) -> str:
    found = np.asarray("" if value is None else value).reshape(-1)
    return str(found[0]) if found.size == 1 and found.dtype.kind == "U" else ""


def _refuse_unpacked(path: Path) -> None:
    """Raises UsageError for a file whose parts unpack to more than a log may have."""
    total = 0
    with path.open("rb") as file:
        file.seek(HEADER)
        while len(tag := file.read(TAG.size)) == TAG.size:
            kind, size = TAG.unpack(tag)
            end = file.tell() + size
            if kind == COMPRESSED:
                total += _unpacked(file, size)
                refuse_long(path, math.inf if total > MOST_BYTES else total)
            file.seek(end)


def _unpacked(file: Any, size: int) -> int:
    """Bytes that the next part of a file unpacks to, counted no further than a log may have."""
    packed, total = zlib.decompressobj(), 0
    while size > 0 and total <= MOST_BYTES and not packed.eof:
        piece = file.read(min(size, PIECE))
        if not piece:
            break
        size -= len(piece)
        try:
            while piece and total <= MOST_BYTES:
                total += len(packed.decompress(piece, PIECE))
                piece = packed.unconsumed_tail
        except zlib.error:
            break  # the reader says what is wrong
    return total
