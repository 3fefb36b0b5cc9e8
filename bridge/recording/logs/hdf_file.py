"""HDF5: MATLAB files of version 7.3, and tables of other programs. Needs h5py.

Links to other files, data that lie elsewhere and references are left out.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bridge.errors import UsageError
from bridge.recording.logs.limits import MOST_CELLS, MOST_COLUMNS, size_of
from bridge.recording.logs.mat_file import DEEPEST, UNITS, table_of
from bridge.recording.logs.reading import Reading
from bridge.recording.logs.table import Table

CLASS = "MATLAB_class"
HIDDEN = ("#refs#", "#subsystem#")


def read_hdf(path: Path, reading: Reading) -> Table:
    """The numbers of an HDF5 file. Raises UsageError for one that cannot be read, and without h5py."""
    try:
        import h5py
    except ImportError:
        raise UsageError(f"{path}: is HDF5 (MATLAB -v7.3), which needs h5py: pip install 'hydrotwin[logs]'") from None
    size_of(path)
    try:
        with h5py.File(path, "r") as file:
            matlab = any(CLASS in file[name].attrs for name in _names(h5py, file))
            parts = list(_parts(h5py, path, file, "", 0))
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        words = " ".join(str(error).split())
        raise UsageError(f"{path}: is HDF5 that cannot be read ({words:.100})") from None
    return table_of(path, parts, "MATLAB, version 7.3" if matlab else "HDF5")


def _names(h5py: Any, group: Any) -> list[str]:
    """What is in the file itself, behind no link."""
    links = ((name, group.get(name, getlink=True)) for name in list(group)[:MOST_COLUMNS])
    return [name for name, link in links if isinstance(link, h5py.HardLink) and name not in HIDDEN]


def _parts(h5py: Any, path: Path, group: Any, before: str, depth: int) -> Iterator[tuple[str, Any, str]]:
    names, cells = _names(h5py, group), 0
    units = group[UNITS] if UNITS in names and isinstance(group[UNITS], h5py.Group) else {}
    for name in names:
        held = group[name]
        if isinstance(held, h5py.Group):
            if name != UNITS and depth < DEEPEST:
                yield from _parts(h5py, path, held, f"{before}{name}.", depth + 1)
        elif isinstance(held, h5py.Dataset) and _plain(held):
            if (cells := cells + held.size) > MOST_CELLS:
                raise UsageError(f"{path}: has more than {MOST_CELLS} numbers; a log may have as many: cut it")
            yield f"{before}{name}", _values(held), _unit(h5py, held, units, name)


def _plain(held: Any) -> bool:
    """Numbers that lie in the file itself."""
    text = _word(held.attrs.get(CLASS, "")) in ("char", "cell", "function_handle")
    return held.dtype.kind in "iufb" and not held.is_virtual and not held.external and not text and held.ndim <= 2


def _values(held: Any) -> Any:
    """MATLAB keeps matrices the other way round."""
    found = held[()]
    return np.asarray(found).T if CLASS in held.attrs else np.asarray(found)


def _unit(h5py: Any, held: Any, units: Any, name: str) -> str:
    """Of an attribute, or of MATLAB's text beside it."""
    for key in ("unit", "units", "Unit", "Units"):
        if key in held.attrs:
            return _word(held.attrs[key])
    if name in units and isinstance(units[name], h5py.Dataset) and units[name].dtype.kind == "u":
        return "".join(map(chr, np.asarray(units[name][()]).reshape(-1)[:40].tolist()))
    return ""


def _word(value: Any) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)
