"""Which kind of log a file is, by how it begins, and the reader of each."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from bridge.errors import UsageError
from bridge.recording.logs.packed import head
from bridge.recording.logs.reading import Reading
from bridge.recording.logs.table import Table

Reader = Callable[[Path, Reading], Table]
LOOKED_AT = 520  # bytes: HDF5 of MATLAB begins after 512


class Form(NamedTuple):
    """A kind of log."""

    begins: bytes
    at: int
    module: str  # in this folder, and its function


FORMS = (
    Form(b"\x89MCAP0\r\n", 0, "bag_file:read_mcap"),
    Form(b"SQLite format 3\0", 0, "bag_file:read_sqlite"),
    Form(b"MDF     ", 0, "mdf_file:read_mdf"),
    Form(b"\x89HDF\r\n\x1a\n", 0, "hdf_file:read_hdf"),
    Form(b"\x89HDF\r\n\x1a\n", 512, "hdf_file:read_hdf"),
    Form(b"MATLAB 5.0", 0, "mat_file:read_mat"),
    Form(b"PAR1", 0, "parquet_file:read_parquet"),
)
OTHERS = {  # beginnings of what is no log, and the way out
    b"PK\x03\x04": "is a packed archive or a spreadsheet: save the table as CSV, or unpack the archive",
    b"\xd0\xcf\x11\xe0": "is a spreadsheet of an old kind: save the table as CSV",
    b"UnFinMF ": "is MDF that was not closed: finish it with the program that has written it",
    b"#ROSBAG V": "is a bag of ROS 1: convert it with rosbags-convert",
}


def read_log(path: Path, reading: Reading) -> Table:
    """A log of any kind. Raises UsageError with one sentence for what cannot be read."""
    if path.is_dir():
        return _reader("bag_file:read_folder")(path, reading)
    first = head(path, LOOKED_AT)
    for beginning, words in OTHERS.items():
        if first.startswith(beginning):
            raise UsageError(f"{path}: {words}")
    found = next((form.module for form in FORMS if first[form.at :].startswith(form.begins)), "csv_file:read_csv")
    return _reader(found)(path, reading)


def _reader(place: str) -> Reader:
    from importlib import import_module

    module, _, function = place.partition(":")
    return getattr(import_module(f"bridge.recording.logs.{module}"), function)
