"""Which kind of log a file is, by how it begins and by its name, and the reader of each."""

from pathlib import Path

from bridge.errors import UsageError
from bridge.recording.logs.reading import Reading
from bridge.recording.logs.table import Table


def read_log(path: Path, reading: Reading) -> Table:
    """A log of any kind. Raises UsageError with one sentence for what cannot be read."""
    from bridge.recording.logs.csv_file import read_csv

    if not path.exists():
        raise UsageError(f"{path}: No such file or directory")
    return read_csv(path, reading)
