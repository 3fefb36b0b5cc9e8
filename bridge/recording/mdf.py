"""A recording as MDF 4.1, the form of measurement systems: a group per topic with its own times. Needs asammdf."""

import logging
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from bridge.errors import UsageError, reason
from bridge.recording.reader import Recording
from bridge.recording.tables import Column
from bridge.wire.messages import TOPICS

VERSION = "4.10"  # of the standard; what the tools of the field read without a converter
ENDING = ".mf4"
DEFLATE = 1  # the compression that every reader of MDF 4.1 knows
RECORDED = "%Y-%m-%dT%H:%M:%S%z"


def write_mdf(recording: Recording, tables: dict[str, list[Column]], path: Path) -> list[Path]:
    """Write tables to one file; every channel TOPIC.FIELD with its unit and comment. Raises UsageError without asammdf.

    The file begins at the wall time at which the run was recorded; times are simulated, from the start of the run.
    """
    try:
        from asammdf import MDF, Signal
    except ImportError:
        raise UsageError("MDF needs asammdf: pip install 'hydrotwin[logs]'") from None
    logging.getLogger("asammdf").setLevel(logging.CRITICAL)
    with MDF(version=VERSION) as file:
        file.start_time = _begin(recording)
        for topic, (time, *columns) in tables.items():
            signals = [
                Signal(
                    _samples(column.values),
                    time.values,
                    name=f"{topic}.{column.name}",
                    unit=column.unit,
                    comment=column.comment,
                    encoding="utf-8" if isinstance(column.values, list) else None,
                )
                for column in columns
            ]
            file.append(signals, acq_name=topic, comment=TOPICS[topic].type, common_timebase=True)
        return [_saved(file, path)]


def _saved(file: Any, path: Path) -> Path:
    """asammdf puts its own ending in place of another, and leaves a file of that name as it is."""
    if path.suffix.lower() != ENDING:
        raise UsageError(f"{path}: a file of MDF 4 ends in {ENDING}; write -o {path.stem}{ENDING}")
    try:
        return Path(file.save(path, overwrite=True, compression=DEFLATE))
    except OSError as error:
        raise UsageError(reason(error)) from None


def _samples(values: Any) -> Any:
    return np.array([text.encode() for text in values]) if isinstance(values, list) else np.ascontiguousarray(values)


def _begin(recording: Recording) -> datetime:
    """When it was recorded; of a file that does not say, when that file was written."""
    try:
        return datetime.strptime(recording.metadata["run"]["recorded"], RECORDED)
    except (KeyError, TypeError, ValueError):
        return datetime.fromtimestamp(recording.path.stat().st_mtime).astimezone()
