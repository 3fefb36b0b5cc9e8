"""CSV in all its dialects, read in blocks: comments before the head, units below it, a last row that was cut off."""

import csv
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError
from bridge.recording.logs.headers import known_unit, parted
from bridge.recording.logs.limits import LONGEST_NAME, refuse_large
from bridge.recording.logs.packed import content
from bridge.recording.logs.reading import Reading
from bridge.recording.logs.table import Column, Table, Words
from bridge.recording.logs.text import SPACES, Shape, at_end, decoded, lines_of, shape_of

BLOCK = 20_000  # rows
PROFILE = 100  # rows at the end that say which columns are numbers
MOST_RAGGED = 0.01  # share of the rows that may have another number of cells than the head
FEW = 5  # such rows that a short file may have
DECIMALS = {",": "a decimal comma", ".": "a decimal point"}
NAMES = {"\t": "tabs", SPACES: "spaces"}
Row = tuple[int, list[str]]  # number of the line, from 1


class Head(NamedTuple):
    """What stands above the rows of numbers."""

    names: list[str]
    units: list[str]
    first: int  # line of the first row of numbers, from 0


def read_csv(path: Path, reading: Reading) -> Table:
    """A text of rows and columns. Raises UsageError with one sentence for what is not one."""
    raw, said = content(path)
    text, encoding = decoded(path, raw, reading)
    lines = lines_of(path, text)
    if not any(line.strip() for line in lines):
        raise UsageError(f"{path}: is empty; there is nothing to import")
    shape = shape_of(lines, reading)
    head = _head(path, lines, shape, reading)
    rows = _Rows(path, head, shape, reading)
    rows.take(_rows(lines, head.first, shape))
    form = f"CSV with {NAMES.get(shape.delimiter, repr(shape.delimiter))}, {DECIMALS[shape.decimal]}, {encoding}"
    return Table(form, rows.columns(), said + rows.notes())


def _rows(lines: list[str], first: int, shape: Shape) -> Iterator[Row]:
    """The cells of each line that has any, from a line on."""
    if shape.delimiter == SPACES:
        yield from ((number, line.split()) for number, line in enumerate(lines[first:], first + 1) if line.strip())
        return
    reader = csv.reader((f"{line}\n" for line in islice(lines, first, None)), delimiter=shape.delimiter)
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells):
                yield first + reader.line_num, cells
    except csv.Error as error:
        raise UsageError(f"line {first + reader.line_num}: cannot be taken apart into cells ({error})") from None


def is_number(cell: str, decimal: str) -> bool:
    """Is a cell a number, with a decimal sign?"""
    written = cell.strip()
    if decimal == "," and "." in written:
        return False
    try:
        float(written.replace(",", ".") if decimal == "," else written)
    except ValueError:
        return False
    return "_" not in written


def _head(path: Path, lines: list[str], shape: Shape, reading: Reading) -> Head:
    """Where the numbers begin, and the names and units above them."""
    last = at_end(list(_rows(lines, max(0, len(lines) - 2 * PROFILE), shape)), PROFILE)
    width = max(map(len, (cells for _, cells in last)), key=[len(cells) for _, cells in last].count)
    numeric = [
        column
        for column in range(width)
        if 2 * sum(_is(cells, column, shape, reading) for _, cells in last) > len(last)
    ]
    first = _first(lines, width, numeric, shape, reading)
    if not numeric or first is None:
        raise UsageError(
            f"{path}: no rows of numbers were found, taken as {NAMES.get(shape.delimiter, repr(shape.delimiter))} "
            f"between cells and {DECIMALS[shape.decimal]}: say in the map [log] delimiter, decimal, header"
        )
    return _named(path, lines, first, width, shape, reading)


def _is(cells: list[str], column: int, shape: Shape, reading: Reading) -> bool:
    return column < len(cells) and (is_number(cells[column], shape.decimal) or reading.is_missing(cells[column]))


def _first(lines: list[str], width: int, numeric: list[int], shape: Shape, reading: Reading) -> int | None:
    """The first line, from 0, whose numeric columns hold numbers, at least one of them not missing."""
    begin = max(reading.header, reading.units)
    for number, cells in _rows(lines, begin, shape):
        filled = [c for c in numeric if c < len(cells) and is_number(cells[c], shape.decimal)]
        if len(cells) == width and filled and all(_is(cells, c, shape, reading) for c in numeric):
            return number - 1
    return None


def _named(path: Path, lines: list[str], first: int, width: int, shape: Shape, reading: Reading) -> Head:
    above = [n for n in range(first) if lines[n].strip()]
    units_at = reading.units - 1 if reading.units else _units_line(lines, above, width, shape)
    if reading.header:
        names_at: int | None = reading.header - 1
    else:
        left = [n for n in above if units_at is None or n < units_at]
        names_at = left[-1] if left and abs(len(_cells(lines[left[-1]], shape)) - width) <= 1 else None
    names = _cells(lines[names_at], shape) if names_at is not None else [f"column{i}" for i in range(1, width + 1)]
    names = [name.strip().lstrip("#").strip()[:LONGEST_NAME] for name in names]
    if len(names) == width - 1 and shape.delimiter != SPACES:  # rows end with a separator
        names.append("")
    if len(names) == width + 1 and not names[0]:  # "# t x y" between spaces
        names = names[1:]
    if len(names) != width:
        raise UsageError(f"{path}: {len(names)} names stand above rows of {width} numbers; say [log] header, the line")
    units = [] if units_at is None else [_unit(cell) for cell in _cells(lines[units_at], shape)]
    return Head(names, [*units, *[""] * width][:width], first)


def _cells(line: str, shape: Shape) -> list[str]:
    if shape.delimiter == SPACES:
        return line.lstrip("# %").split()
    return next(csv.reader([line], delimiter=shape.delimiter), [])


def _unit(cell: str) -> str:
    return known_unit(cell.strip().strip("[]()")) or ""


def _units_line(lines: list[str], above: list[int], width: int, shape: Shape) -> int | None:
    """The line right above the numbers, if it holds units: something known, and nothing but units and dashes."""
    if len(above) < 2:
        return None
    found = [known_unit(cell.strip().strip("[]()")) for cell in _cells(lines[above[-1]], shape)]
    return above[-1] if abs(len(found) - width) <= 1 and any(found) and None not in found else None


class _Rows:
    """Rows as they come, block by block turned into numbers."""

    def __init__(self, path: Path, head: Head, shape: Shape, reading: Reading) -> None:
        self._path, self._head, self._shape, self._reading = path, head, shape, reading
        self._blocks: list[list[NDArray[np.float64]]] = [[] for _ in head.names]
        self._texts: list[list[str] | None] = [[] for _ in head.names]  # None once a number was among them
        self._words: dict[int, Words] = {}
        self._ragged: list[int] = []  # lines
        self._count = 0

    def take(self, rows: Iterator[Row]) -> None:
        width = len(self._head.names)
        while block := list(islice(rows, BLOCK)):
            self._ragged += [number for number, cells in block if len(cells) != width]
            whole = [(number, cells) for number, cells in block if len(cells) == width]
            self._count += len(whole)
            refuse_large(self._path, self._count, width)
            self._refuse_ragged()
            for column in range(width):
                self._add(column, [n for n, _ in whole], [cells[column] for _, cells in whole])

    def columns(self) -> dict[str, Column]:
        """Each under its name as the file has it; of a name that is there twice the second gets a number."""
        found: dict[str, Column] = {}
        for place, head in enumerate(self._head.names):
            name, unit = parted(head)
            key = head or f"column{place + 1}"
            while key in found:
                key += " 2"
            blocks = self._blocks[place]
            values = np.concatenate(blocks) if blocks else np.zeros(0)
            texts = self._texts[place] if np.isnan(values).all() else None
            found[key] = Column(name or key, self._head.units[place] or unit, values, self._words.get(place), texts)
        return found

    def notes(self) -> tuple[str, ...]:
        """What was left out."""
        if not self._ragged:
            return ()
        return (f"{len(self._ragged)} rows with another number of cells left out, the first in line {self._ragged[0]}",)

    def _refuse_ragged(self) -> None:
        if len(self._ragged) > max(FEW, MOST_RAGGED * self._count):
            raise UsageError(
                f"{self._path}: {len(self._ragged)} rows have another number of cells than the head, which has "
                f"{len(self._head.names)}, the first in line {self._ragged[0]}: say [log] delimiter and decimal"
            )

    def _add(self, column: int, lines: list[int], cells: list[str]) -> None:
        values = self._numbers(column, lines, cells)
        self._blocks[column].append(values)
        texts = self._texts[column]
        self._texts[column] = None if texts is None or not np.isnan(values).all() else texts + cells

    def _numbers(self, column: int, lines: list[int], cells: list[str]) -> NDArray[np.float64]:
        comma = self._shape.decimal == ","
        if not comma or not any("." in cell for cell in cells):
            plain = [cell.replace(",", ".") for cell in cells] if comma else cells
            try:
                found = np.array(plain, dtype=np.str_).astype(np.float64)
            except ValueError:
                pass
            else:
                return np.where(np.isfinite(found), found, np.nan)
        return np.array([self._number(column, n, cell) for n, cell in zip(lines, cells, strict=True)], dtype=np.float64)

    def _number(self, column: int, line: int, cell: str) -> float:
        if self._reading.is_missing(cell):
            return np.nan
        if is_number(cell, self._shape.decimal):
            return float(cell.replace(",", ".") if self._shape.decimal == "," else cell)
        known = self._words.get(column)
        self._words[column] = known._replace(number=known.number + 1) if known else Words(1, f"line {line}", cell)
        return np.nan
