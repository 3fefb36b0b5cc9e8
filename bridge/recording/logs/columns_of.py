"""Columns made of arrays of any kind: numbers of all types, times, texts; tables of several columns taken apart."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.recording.logs.headers import known_unit, parted
from bridge.recording.logs.limits import LONGEST_NAME
from bridge.recording.logs.table import Column, Words

WIDEST = 64  # columns of one matrix: more are an image or a spectrum, not signals of a drive


def column(name: str, values: Any, unit: str = "", clock: NDArray[np.int64] | None = None) -> Column | None:
    """A column of a plain array of one dimension; None for what is neither numbers, times nor texts."""
    found, name = np.asarray(values), name[:LONGEST_NAME]
    unit = known_unit(unit) or parted(name.removesuffix(".data"))[1]
    if found.ndim != 1:
        return None
    if found.dtype.kind == "M":
        return _times(name, found, clock)
    if found.dtype.kind in "iu":
        return Column(name, unit, found.astype(np.float64), None, None, clock, _whole(found))
    if found.dtype.kind in "bf":
        numbers = found.astype(np.float64)
        return Column(name, unit, np.where(np.isfinite(numbers), numbers, np.nan), clock=clock)
    if found.dtype.kind in "US":
        texts = [_text(entry) for entry in found.tolist()]
        words = Words(len(texts), "row 1", texts[0] if texts else "")
        return Column(name, unit, np.full(len(texts), np.nan), words, texts, clock)
    return None


def _text(entry: Any) -> str:
    return entry.decode(errors="replace") if isinstance(entry, bytes) else str(entry)


def _whole(values: NDArray[Any]) -> NDArray[np.int64] | None:
    """Whole numbers as they are; None where one is too large."""
    if values.dtype.kind == "u" and len(values) and int(values.max()) > np.iinfo(np.int64).max:
        return None
    return values.astype(np.int64)


def _times(name: str, found: NDArray[Any], clock: NDArray[np.int64] | None) -> Column:
    whole = found.astype("datetime64[ns]").astype(np.int64)
    return Column(name, "ns", whole.astype(np.float64), None, None, clock, whole)


def taken_apart(name: str, values: Any) -> Iterator[tuple[str, Any]]:
    """An array under its name; of a matrix each column, NAME[1] and so on, of a row its numbers below one another."""
    found = np.asarray(values)
    if found.ndim == 2 and 1 in found.shape:
        found = found.reshape(-1)
    if found.ndim == 1 and len(found) > 1:
        yield name, found
    elif found.ndim == 2 and found.shape[-1] <= WIDEST:
        yield from ((f"{name}[{i + 1}]", found[:, i]) for i in range(found.shape[-1]))
    elif found.ndim == 2 and found.shape[0] <= WIDEST:
        yield from ((f"{name}[{i + 1}]", found[i]) for i in range(len(found)))
