"""Recordings for other programs: CSV and Parquet, a file for each channel; MATLAB and MDF, one for all; a rosbag2."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from bridge.errors import UsageError, writing
from bridge.recording.mdf import ENDING as MDF_ENDING
from bridge.recording.mdf import write_mdf
from bridge.recording.reader import Recording
from bridge.recording.tables import Column, table

Writer = Callable[[dict[str, list[Column]], Path], list[Path]]


def export(recording: Recording, topics: list[str], form: str, output: Path, absolute: bool = False) -> list[Path]:
    """Write topics to a folder (csv, parquet, rosbag2) or to a file (mat, mdf); the files written.

    absolute: pressures above a vacuum, not gauge.
    """
    if form == BAG:
        from bridge.recording.rosbag2 import write_bag

        return write_bag(recording, topics, output)
    tables = {topic: table(recording, topic, absolute) for topic in topics if recording.counts.get(topic)}
    if not tables:
        raise UsageError(f"{recording.path}: there is nothing in it to export")
    with writing(output):
        if form == MDF:
            return write_mdf(recording, tables, output)
        return FORMS[form](tables, output)


def _csv(tables: dict[str, list[Column]], folder: Path) -> list[Path]:
    import csv

    paths = []
    for path, columns in _in_folder(tables, folder, "csv"):
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(column.header for column in columns)
            plain = [c.values if isinstance(c.values, list) else c.values.tolist() for c in columns]
            writer.writerows(zip(*plain, strict=True))
        paths.append(path)
    return paths


def _parquet(tables: dict[str, list[Column]], folder: Path) -> list[Path]:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise UsageError("Parquet needs pyarrow: pip install 'hydrotwin[parquet]'") from None
    paths = []
    for path, columns in _in_folder(tables, folder, "parquet"):
        arrays = [
            pyarrow.array(np.ascontiguousarray(c.values) if not isinstance(c.values, list) else c.values)
            for c in columns
        ]
        fields = [
            pyarrow.field(c.header, array.type, metadata={"unit": c.unit})
            for c, array in zip(columns, arrays, strict=True)
        ]
        pyarrow.parquet.write_table(pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields)), path)
        paths.append(path)
    return paths


def _mat(tables: dict[str, list[Column]], path: Path) -> list[Path]:
    """A structure for each channel: columns by name, and below `units` their units by the same names."""
    from scipy.io import savemat

    content: dict[str, Any] = {}
    for topic, columns in tables.items():
        values = {_identifier(c.name): _numbers(c.values) for c in columns}
        content[_identifier(topic)] = values | {"units": {_identifier(c.name): c.unit for c in columns}}
    savemat(path, content, long_field_names=True, oned_as="column")
    return [path]


def _numbers(values: Any) -> Any:
    return np.array(values, dtype=object) if isinstance(values, list) else values


def _identifier(name: str) -> str:
    """As MATLAB has names: letters, digits and underscores, at most 63."""
    return re.sub(r"\W+", "_", name).strip("_")[:63]


def _in_folder(tables: dict[str, list[Column]], folder: Path, ending: str) -> list[tuple[Path, list[Column]]]:
    folder.mkdir(parents=True, exist_ok=True)
    return [(folder / f"{topic.replace('/', '_')}.{ending}", columns) for topic, columns in tables.items()]


FORMS: dict[str, Writer] = {"csv": _csv, "parquet": _parquet, "mat": _mat}
BAG, MDF = "rosbag2", "mdf"  # forms that need more of a recording than its tables
ENDINGS = {"mat": ".mat", MDF: MDF_ENDING}  # of forms that are one file; the others are folders
