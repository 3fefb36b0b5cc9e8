"""A text file of unknown origin: its encoding, its lines, and what separates its cells."""

import codecs
import re
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import UsageError
from bridge.recording.logs.limits import LONGEST_ROW
from bridge.recording.logs.reading import Reading

MARKS = (  # the longer first: UTF-32 begins as UTF-16 does
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
LOOKED_AT = 4000  # bytes from the beginning, for NULs
SEPARATORS = (";", "\t", "|", ",")  # a comma last: it may be a decimal sign
SAMPLE = 60  # lines from the end, by which the separator is found
NUMBER = re.compile(r"^\s*[-+]?(\d+[.,]?\d*|[.,]\d+)([eE][-+]?\d+)?\s*$")
COMMA_NUMBER = re.compile(r"^\s*[-+]?\d*,\d+([eE][-+]?\d+)?\s*$")
STRICT = re.compile(r"^[-+]?(\d+|\d*[.,]\d+)([eE][-+]?\d+)?$")
SPACES = " "
USUAL = 0.8  # share of the lines, or of the cells, that are as they should be


class Shape(NamedTuple):
    """How cells stand in the lines of a text."""

    delimiter: str  # SPACES: any number of them
    decimal: str


def decoded(path: Path, raw: bytes, reading: Reading) -> tuple[str, str]:
    """The text and its encoding. Raises UsageError for what is no text."""
    name = reading.encoding or _encoding(raw)
    try:
        text = raw.decode(name)
    except LookupError:
        raise UsageError(f"{path}: [log] encoding {name!r} is unknown; write 'utf-8', 'cp1252' or 'utf-16'") from None
    except UnicodeDecodeError as error:
        raise UsageError(f"{path}: is not {name} at byte {error.start}; name another [log] encoding") from None
    if "\0" in text:
        raise UsageError(f"{path}: is not a text, nor a form of log that is known here")
    return text.removeprefix("\ufeff"), name.removesuffix("-sig")


def _encoding(raw: bytes) -> str:
    for mark, name in MARKS:
        if raw.startswith(mark):
            return name
    first = raw[:LOOKED_AT]
    if first.count(0) > len(first) // 4:  # UTF-16 without a mark: every other byte of plain letters is 0
        return "utf-16-le" if first[1::2].count(0) > first[::2].count(0) else "utf-16-be"
    try:
        raw.decode("utf-8")
    except UnicodeDecodeError:
        return "cp1252" if all(byte not in raw for byte in (0x81, 0x8D, 0x8F, 0x90, 0x9D)) else "latin-1"
    return "utf-8"


def lines_of(path: Path, text: str) -> list[str]:
    """The lines of a text, in its order. Raises UsageError for one that is too long."""
    lines = re.split(r"\r\n|\n|\r", text)
    if any(len(line) > LONGEST_ROW for line in lines):
        raise UsageError(f"{path}: has a line of more than {LONGEST_ROW} characters; it is no table of a log")
    return lines


def shape_of(lines: list[str], reading: Reading) -> Shape:
    """What separates the cells, and which sign stands before decimals."""
    filled = at_end([line for line in lines if line.strip()], SAMPLE)
    delimiter = _tab(reading.delimiter) or _said(lines) or _delimiter(filled)
    return Shape(delimiter, reading.decimal or _decimal(filled, delimiter))


def at_end(rows: list[Any], most: int) -> list[Any]:
    """The last rows of a file, of a short one the lower half: there the head is not among them."""
    return rows[-min(most, (len(rows) + 1) // 2) :]


def _tab(word: str) -> str:
    return "\t" if word in ("\\t", "tab") else word


def _said(lines: list[str]) -> str:
    """Of a first line "sep=;", which spreadsheets write."""
    first = lines[0].strip() if lines else ""
    return first[4:] if first.lower().startswith("sep=") and len(first) == 5 else ""


def _delimiter(lines: list[str]) -> str:
    for sign in SEPARATORS:
        if sign == "," and _spaced(lines):
            return SPACES
        counts = Counter(line.count(sign) for line in lines)
        usual, often = counts.most_common(1)[0] if counts else (0, 0)
        if usual and often >= USUAL * len(lines) and _numbers(lines, sign):
            return sign
    return ","


def _numbers(lines: list[str], sign: str) -> bool:
    """Are numbers among the cells that a separator makes?"""
    cells = [cell.strip('" ') for line in lines for cell in line.split(sign)]
    return any(NUMBER.match(cell) for cell in cells)


def _spaced(lines: list[str]) -> bool:
    """Are the cells numbers between spaces, perhaps with decimal commas?"""
    rows = [line.split() for line in lines]
    usual, often = Counter(map(len, rows)).most_common(1)[0] if rows else (0, 0)
    cells = [cell for row in rows if len(row) == usual for cell in row]
    return usual > 1 and often >= USUAL * len(rows) and sum(map(bool, map(STRICT.match, cells))) >= USUAL * len(cells)


def _decimal(lines: list[str], delimiter: str) -> str:
    if delimiter == ",":
        return "."
    cells = [
        cell.strip('" ') for line in lines for cell in (line.split() if delimiter == SPACES else line.split(delimiter))
    ]
    return "," if any(COMMA_NUMBER.match(cell) for cell in cells) else "."
