"""Parquet: one table, units in the heads or in the fields' own notes. Needs pyarrow."""

from pathlib import Path
from typing import Any

import numpy as np

from bridge.errors import UsageError
from bridge.recording.logs.columns_of import column
from bridge.recording.logs.headers import parted
from bridge.recording.logs.limits import refuse_large, refuse_long, size_of
from bridge.recording.logs.reading import Reading
from bridge.recording.logs.table import Column, Table


def read_parquet(path: Path, reading: Reading) -> Table:
    """The columns of a Parquet file. Raises UsageError for one that cannot be read, and without pyarrow."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise UsageError(f"{path}: is Parquet, which needs pyarrow: pip install 'hydrotwin[parquet]'") from None
    size_of(path)
    try:
        with pyarrow.parquet.ParquetFile(path) as file:
            about = file.metadata
            refuse_large(path, about.num_rows, about.num_columns)
            refuse_long(path, sum(about.row_group(i).total_byte_size for i in range(about.num_row_groups)))
            held = file.read()
    except (pyarrow.ArrowException, OSError, ValueError) as error:
        words = " ".join(str(error).split())
        raise UsageError(f"{path}: is Parquet that cannot be read ({words:.100})") from None
    made = (_column(pyarrow, field, held.column(place)) for place, field in enumerate(held.schema))
    found = {name: one for name, one in made if one is not None}
    if not found:
        raise UsageError(f"{path}: holds no column of numbers")
    return Table("Parquet", found)


def _column(pyarrow: Any, field: Any, chunked: Any) -> tuple[str, Column | None]:
    """Under the field's whole name; what is missing is NaN."""
    unit = (field.metadata or {}).get(b"unit", b"").decode(errors="replace")
    name, said = parted(field.name)
    kind = field.type
    if pyarrow.types.is_timestamp(kind) or pyarrow.types.is_date(kind):
        made = column(name, chunked.cast(pyarrow.timestamp("ns", getattr(kind, "tz", None))).to_numpy())
    elif pyarrow.types.is_integer(kind) and not chunked.null_count:
        made = column(name, chunked.to_numpy(), unit or said)
    elif pyarrow.types.is_floating(kind) or pyarrow.types.is_integer(kind) or pyarrow.types.is_boolean(kind):
        made = column(name, np.asarray(chunked.cast(pyarrow.float64()).to_numpy(), np.float64), unit or said)
    elif pyarrow.types.is_string(kind) or pyarrow.types.is_large_string(kind):
        made = column(name, np.array([text or "" for text in chunked.to_pylist()], dtype=np.str_), unit or said)
    else:
        made = None
    return field.name, made
