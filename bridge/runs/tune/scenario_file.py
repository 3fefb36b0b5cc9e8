"""The result of a search as a scenario file that extends the one it began with."""

import json
import os
from collections.abc import Sequence
from pathlib import Path

from bridge.errors import UsageError, visible, writing
from bridge.scenario import names
from bridge.scenario.files import parsed_change

MADE_BY = "# Found by hydrotwin tune"
FILES = ("controller.law", "reference.csv")  # values that name a file of the working folder


def refuse_foreign(path: Path) -> None:
    """Raises UsageError for a file that is there and was not made by a search."""
    if path.suffix != ".toml":
        raise UsageError(f"-o {path}: a scenario is a TOML file; name one that ends in .toml")
    if path.is_file() and not path.read_text(encoding="utf-8", errors="replace").startswith(MADE_BY):
        raise UsageError(f"-o {path}: is there and was not written by hydrotwin tune; name another file")


def write_scenario(path: Path, extends: str, changes: Sequence[str], words: str) -> Path:
    """A file that has these changes, the later of equal names."""
    folder = path.parent
    values = dict(_as_toml(change, folder) for change in changes)
    lines = [f"{MADE_BY}: {visible(words)}", f"extends = {json.dumps(_beside(extends, folder))}"]
    with writing(path):
        path.write_text("\n".join([*lines, *(f"{n} = {v}" for n, v in values.items())]) + "\n", encoding="utf-8")
    return path


def _beside(extends: str, folder: Path) -> str:
    return extends if extends in names() else os.path.relpath(extends, folder)


def _as_toml(change: str, folder: Path) -> tuple[str, str]:
    name, value = parsed_change(change)
    if name in FILES and isinstance(value, str):
        file, colon, function = value.rpartition(":") if name == "controller.law" else (value, "", "")
        if Path(file).is_file():
            value = f"{os.path.relpath(file, folder)}{colon}{function}"
    return name, json.dumps(value, default=str)
