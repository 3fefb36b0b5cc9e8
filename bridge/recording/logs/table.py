"""What every reader of logs returns: columns of numbers with names and units, and when their rows were taken."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError, nearest

LISTED = 12  # names of columns in a message


class Words(NamedTuple):
    """Cells of a column that are text and not a number."""

    number: int
    place: str  # of the first: "row 17"
    first: str


class Column(NamedTuple):
    """One column of a log, in the file's own order."""

    name: str
    unit: str  # as the file states it; "" where it does not
    values: NDArray[np.float64]  # NaN where a cell is empty, is no finite number, or is text
    words: Words | None = None  # what is text in it
    texts: list[str] | None = None  # every cell, where none is a number: times of day, states
    clock: NDArray[np.int64] | None = None  # [ns] of each row, in files that have times beside their columns
    whole: NDArray[np.int64] | None = None  # the values where the file has whole numbers


class Table(NamedTuple):
    """A log."""

    form: str  # in words: "CSV, ';', decimal comma, UTF-16"
    columns: Mapping[str, Column]
    notes: tuple[str, ...] = ()  # what was done to read it, one sentence each

    def column(self, name: str, who: str) -> Column:
        """A column by its name, or by its name without unit where only one has it. Raises UsageError."""
        if name in self.columns:
            return self.columns[name]
        bare = [column for column in self.columns.values() if column.name == name]
        if len(bare) == 1:
            return bare[0]
        known = list(self.columns)
        more = f"{len(known) - LISTED} more" if len(known) > LISTED else ""
        raise UsageError(f"{who}: the log has no column {name!r}{nearest(name, known[:LISTED], more)}")


def numbers(column: Column, who: str) -> NDArray[np.float64]:
    """A column's numbers. Raises UsageError where it holds text."""
    if column.words is not None:
        number, place, first = column.words
        others = f" and {number - 1} more cells" if number > 1 else ""
        raise UsageError(
            f"{who}: column {column.name!r} holds {first[:40]!r} in {place}{others}, which is not a number: "
            f"correct it, or count it as missing with [log] missing = [{first[:40]!r}]"
        )
    return column.values
