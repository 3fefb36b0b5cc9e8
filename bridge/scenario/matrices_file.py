"""A sampled linear law in a file: its matrices A, B, C and D, its dt and its inputs, as other programs save them.

`controller.file` is read when a scenario is loaded, so that the scenario carries the matrices; `controller.origin` says
where they came from, until one of them is changed.
"""

import hashlib
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from bridge.errors import ScenarioError, nearest
from bridge.scenario.untrusted import LONGEST, parsed_json

MATRICES = ("A", "B", "C", "D")
NAMES = (*MATRICES, "dt", "inputs")
NEEDED = ("D", "dt")
NOTHING: dict[str, Any] = {"A": [], "B": [], "C": [[]], "inputs": ["error"]}  # of what a file need not have
MOST_UNPACKED = 16_000_000  # bytes: a law with 1000 states
KIND = "state-space"
SAVE = "save it with save('law.mat', 'A', 'B', 'C', 'D', 'dt', '-v7')"


def with_matrices(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Plain data of a scenario file with the matrices of its controller's file. Raises ScenarioError."""
    controller = data.get("controller")
    if not isinstance(controller, dict) or not _names_file(controller):
        return data
    if given := [key for key in NAMES if key in controller]:
        raise ScenarioError(
            f"controller.file {controller['file']!r} and controller.{given[0]}: give the law once, here or there"
        )
    return data | {"controller": _expanded(controller, folder)}


def note_change(controller: dict[str, Any], key: str) -> None:
    """Plain data of a controller after the change of a value: a file is read, a matrix is no longer from one."""
    if key == "file" and _names_file(controller):
        expanded = _expanded(controller, Path())
        controller.clear()
        controller.update(expanded)
    elif key in NAMES:
        controller.pop("origin", None)


def without_origin(controller: dict[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """What another controller extends; where that gives a matrix itself, nothing says any more where they are from."""
    return {key: value for key, value in controller.items() if key != "origin" or not own.keys() & set(NAMES)}


def _names_file(controller: Mapping[str, Any]) -> bool:
    return isinstance(controller.get("file"), str) and controller.get("kind", KIND) == KIND


def _expanded(controller: dict[str, Any], folder: Path) -> dict[str, Any]:
    name = controller["file"]
    path = folder / name
    if not path.is_file():
        raise ScenarioError(f"controller.file {name!r}: there is no such file beside the scenario or in {Path.cwd()}")
    if path.stat().st_size > LONGEST:
        raise ScenarioError(f"controller.file {name!r}: is longer than {LONGEST} bytes, which no law's matrices need")
    kept = {key: value for key, value in controller.items() if key not in ("file", *NAMES)}
    origin = {"file": path.name, "sha256": hashlib.sha256(path.read_bytes()).hexdigest()}
    return kept | NOTHING | matrices_of(path, name) | {"origin": origin}


def matrices_of(path: Path, name: str) -> dict[str, Any]:
    """What a file says of a law, as plain data. Raises ScenarioError."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise ScenarioError(f"controller.file {name!r}: give a file that ends in {', '.join(READERS)}")
    try:
        return _plain(reader(path))
    except ValueError as error:
        raise ScenarioError(f"controller.file {name!r} {error}") from None
    except OSError as error:
        raise ScenarioError(f"controller.file {name!r}: {error.strerror}") from None


def _plain(held: Mapping[str, Any]) -> dict[str, Any]:
    """Raises ValueError for what is missing, not known, or not a matrix of numbers."""
    if {"continuous", "sampled"} <= held.keys():
        words = "is the linear model of a rig, as `hydrotwin linearise` writes it, and not a controller"
        raise ValueError(f"{words}: give A, B, C, D and dt of a law")
    if missing := [key for key in NEEDED if key not in held]:
        near = ", ".join(held) or "nothing"
        raise ValueError(f"has no {missing[0]}: a law is A, B, C, D, dt and perhaps inputs (it holds {near:.200})")
    if further := [key for key in held if key not in NAMES]:
        raise ValueError(f"holds {further[0]!r}, which a law does not have{nearest(further[0], NAMES)}")
    found = {key: _matrix(key, held[key]) for key in MATRICES if key in held}
    if not found.get("A") and not any(found.get("C", [])):
        found["C"] = [[]]  # of a law without a state, however it was saved
    words = {"inputs": _words(held["inputs"])} if "inputs" in held else {}
    return found | {"dt": _period(held["dt"])} | words


def _matrix(name: str, value: Any) -> list[list[float]]:
    import numpy as np

    value = value.toarray() if hasattr(value, "toarray") else value  # sparse
    try:
        found = np.asarray(value)
    except ValueError:
        raise ValueError(f"has rows of different lengths in {name}") from None
    if found.ndim != 2 and found.size:
        raise ValueError(f"has a matrix {name} that is not two-dimensional: write rows of numbers")
    if np.iscomplexobj(found):
        raise ValueError(f"has complex numbers in {name}: bring the law into real form first")
    if found.dtype.kind not in "iufb" or found.dtype.kind == "b":
        raise ValueError(f"holds something else than numbers in {name}")
    if not np.isfinite(found).all():
        raise ValueError(f"holds a number that is not finite in {name}")
    return found.astype(float).tolist() if found.ndim == 2 else []


def _period(value: Any) -> Any:
    import numpy as np

    if isinstance(value, str):
        return value
    found = np.asarray(value)
    if found.size != 1 or found.dtype.kind not in "iuf":
        raise ValueError("has a dt that is not one number: give the sampling period in seconds")
    period = float(found.reshape(-1)[0])
    if not period > 0.0:
        raise ValueError(f"has dt {period:g}: a law is sampled; discretise it, and give its sampling period in seconds")
    return period


def _words(value: Any) -> list[str]:
    """Texts in a list, in an array, or in a cell array of MATLAB."""
    import numpy as np

    entries = [value] if isinstance(value, str) else list(np.asarray(value, dtype=object).reshape(-1))
    words = [np.asarray(entry).reshape(-1) for entry in entries]
    if not all(len(word) == 1 and isinstance(word[0], str) for word in words):
        raise ValueError("has inputs that are not names: give texts, such as 'error' and 'velocity'")
    return [str(word[0]).strip() for word in words]


class _TooLargeError(ValueError):
    """What a file unpacks to."""


def _refuse_large(size: int) -> None:
    if size > MOST_UNPACKED:
        raise _TooLargeError(f"unpacks to {size} bytes; the matrices of a law have at most {MOST_UNPACKED}")


def _json(path: Path) -> dict[str, Any]:
    try:
        held = parsed_json(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"is not JSON: {error}") from None
    if not isinstance(held, dict):
        raise ValueError(
            'is not a table of names: write {"A": [[..]], "B": [[..]], "C": [[..]], "D": [[..]], "dt": 0.01}'
        )
    return held


def _npz(path: Path) -> dict[str, Any]:
    import zipfile
    import zlib

    import numpy as np

    try:
        with zipfile.ZipFile(path) as packed:
            _refuse_large(sum(entry.file_size for entry in packed.infolist()))
        with np.load(path, allow_pickle=False) as held:  # a pickle could run code
            return dict(held)
    except _TooLargeError:
        raise
    except (ValueError, MemoryError, zlib.error, EOFError, TypeError, AttributeError, zipfile.BadZipFile) as error:
        words = " ".join(str(error).split())
        raise ValueError(f"is not an archive of plain arrays: save it with numpy.savez ({words:.100})") from None


def _mat(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat, whosmat

    try:
        _refuse_large(sum(8 * math.prod(map(int, shape)) for _, shape, _ in whosmat(path)))
        held = loadmat(path)
    except _TooLargeError:
        raise
    except NotImplementedError:
        raise ValueError(f"is a MATLAB file of version 7.3, which is HDF5: {SAVE}") from None
    except Exception as error:  # of many kinds, from a reader of damaged bytes
        words = " ".join(str(error).split())
        raise ValueError(f"is not a MATLAB file that can be read: {SAVE} ({words:.100})") from None
    return {key: value for key, value in held.items() if not key.startswith("__")}


READERS: dict[str, Callable[[Path], dict[str, Any]]] = {".json": _json, ".npz": _npz, ".mat": _mat}
