"""Limits of logs that anybody may have written: assumed, well above what a test on a rig leaves. docs/security.md."""

import math
from pathlib import Path

from bridge.errors import UsageError, reason

MOST_BYTES = 500_000_000  # of a file, unpacked
MOST_ROWS = 5_000_000  # of a column: 80 minutes at 1 kHz
MOST_COLUMNS = 2_000
MOST_CELLS = 50_000_000  # of all columns together: 400 MB as numbers
LONGEST_ROW = 1_000_000  # characters
LONGEST_NAME = 200  # characters of a column's name


def refuse_large(path: Path, rows: int, columns: int) -> None:
    """Raises UsageError for a table that is larger than a log may be."""
    for number, most, what in ((columns, MOST_COLUMNS, "columns"), (rows, MOST_ROWS, "rows")):
        if number > most:
            raise UsageError(f"{path}: has {number} {what}; a log may have {most}: cut it into pieces")
    if rows * columns > MOST_CELLS:
        raise UsageError(
            f"{path}: has {rows} rows of {columns} columns; a log may have {MOST_CELLS} numbers: leave columns out"
        )


def refuse_long(path: Path, size: float) -> None:
    """Raises UsageError for a file that is, or unpacks to, more bytes than a log may have."""
    if not size <= MOST_BYTES:
        words = f"{size:.0f} bytes" if math.isfinite(size) else "too many bytes"
        raise UsageError(f"{path}: has {words} unpacked; a log may have {MOST_BYTES}: cut it into pieces")


def size_of(path: Path) -> int:
    """Bytes of a file. Raises UsageError for one that is not there or is too large."""
    try:
        size = path.stat().st_size
    except OSError as error:
        raise UsageError(reason(error)) from None
    refuse_long(path, size)
    return size
