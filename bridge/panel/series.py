"""Numbers of a topic as they come in: kept at full rate for a while, thinned for a page without losing peaks."""

import math
from collections import deque
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.recording.entries import Entry
from bridge.wire.channels import Layout, format_of
from bridge.wire.messages import CHANNELS_TOPIC, TOPICS, field_names, struct_format
from controller.grid import NS

CODES = {"Q": "<u8", "q": "<i8", "d": "<f8"}
Rows = NDArray[Any]  # one row per message, by the names of its fields


class Points(NamedTuple):
    """Thinned rows: of each stretch two, which hold the least and the greatest value of every field."""

    time: NDArray[np.float64]  # [s]
    values: NDArray[np.float64]  # one column per field that was asked for


def dtype_of(topic: str, layout: Layout = ()) -> np.dtype[Any]:
    """How the messages of a flat topic lie in memory behind their CDR header."""
    kind = TOPICS[topic].type
    names, codes = field_names(kind), struct_format(kind)
    if topic == CHANNELS_TOPIC:
        names, codes = [*names, *(field.name for field in layout)], format_of(layout)
    assert codes is not None
    return np.dtype([(name, CODES[code]) for name, code in zip(names, codes[3:], strict=True)])


class Series:
    """One topic of one run."""

    def __init__(self, kind: np.dtype[Any], keeps: int) -> None:
        """keeps: rows at full rate, at least."""
        self.kind = kind
        self._keeps = keeps
        self._parts: deque[Rows] = deque()
        self._rows = 0

    def add(self, entries: list[Entry]) -> Rows:
        """Take messages; returns them as rows. What is longer or shorter than a row of the run is left out."""
        own = [entry.data[4:] for entry in entries if len(entry.data) == 4 + self.kind.itemsize]
        rows = np.frombuffer(b"".join(own), self.kind)
        if len(rows):
            self._parts.append(rows)
            self._rows += len(rows)
        while self._parts and self._rows - len(self._parts[0]) >= self._keeps:
            self._rows -= len(self._parts.popleft())
        return rows

    def between(self, begin: float, end: float) -> Rows:
        """The rows from one time to another [s] that are kept."""
        parts = [p for p in self._parts if p["stamp"][-1] >= begin * NS and p["stamp"][0] <= end * NS]
        rows = np.concatenate(parts) if parts else np.zeros(0, self.kind)
        return rows[(rows["stamp"] >= begin * NS) & (rows["stamp"] <= end * NS)]


def thinned(rows: Rows, fields: list[str], stretches: int) -> Points:
    """At most so many stretches of the rows; few rows as they are."""
    time = rows["stamp"] / NS
    values = np.empty((len(rows), len(fields)))
    for column, name in enumerate(fields):
        values[:, column] = rows[name]
    length = math.ceil(len(rows) / max(1, stretches))
    if length <= 2:
        return Points(time, values)
    starts = np.arange(0, len(rows), length)
    last = np.minimum(starts + length, len(rows)) - 1
    return Points(np.column_stack([time[starts], time[last]]).ravel(), _extremes(values, len(starts), length))


def _extremes(values: NDArray[np.float64], stretches: int, length: int) -> NDArray[np.float64]:
    """Least and greatest of each stretch, in the order in which they came; NaN where nothing is known."""
    padded = np.full((stretches * length, values.shape[1]), np.nan)
    padded[: len(values)] = values
    table = padded.reshape(stretches, length, -1)
    unknown = np.isnan(table)
    lowest, highest = np.where(unknown, np.inf, table).argmin(axis=1), np.where(unknown, -np.inf, table).argmax(axis=1)
    at = np.stack([np.minimum(lowest, highest), np.maximum(lowest, highest)], axis=1)
    return np.take_along_axis(table, at, axis=1).reshape(2 * stretches, -1)
