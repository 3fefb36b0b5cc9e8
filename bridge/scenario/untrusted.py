"""Files that anybody may have written: read up to a length, and taken apart only when that is certain to end soon.

The limits are assumed: some ten times what the largest of our own files has. docs/security.md lists them.
"""

import json
import re
import tomllib
from pathlib import Path
from typing import Any

from bridge.errors import ScenarioError, reason

LONGEST = 1_000_000  # bytes of a scenario, of a campaign, of the file of a law's matrices
LONGEST_TABLE = 8_000_000  # bytes of a table in CSV: an hour at 100 Hz
DEEPEST = 20  # tables and lists within one another
MOST_FILES = 100  # that a scenario extends, directly or not
_QUOTED = re.compile(
    r'"""(?:\\.|[^\\])*?"""|\'\'\'.*?\'\'\'|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'|#[^\n]*',
    re.DOTALL,
)
_PARTS = re.compile(r"[,=\[\]{}\n]")


def text_of(path: Path, longest: int = LONGEST) -> str:
    """A file: UTF-8 whatever the locale, with or without a mark at its beginning. Raises ScenarioError."""
    try:
        with path.open("rb") as file:
            content = file.read(longest + 1)
    except OSError as error:
        raise ScenarioError(reason(error) if error.filename else f"{path}: {error.strerror}") from None
    if len(content) > longest:
        raise ScenarioError(f"{path}: is longer than {longest} bytes, the most that such a file may have")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{path}: is not UTF-8 at byte {error.start}; save it as UTF-8") from None


def parsed_toml(text: str) -> dict[str, Any]:
    """What a text in TOML says. Raises ValueError for one that is not, and for one that is nested too deeply."""
    bare = _QUOTED.sub("s", text)  # tomllib takes a time that grows with the square of a dotted name
    if any(part.count(".") > DEEPEST for part in _PARTS.split(bare)):
        raise ValueError(_too_deep())
    try:
        data = tomllib.loads(text)
    except RecursionError:
        raise ValueError(_too_deep()) from None
    refuse_deep(data)
    return data


def parsed_json(text: str | bytes) -> Any:
    """What a text in JSON says. Raises ValueError as `parsed_toml` does."""
    try:
        data = json.loads(text)
    except RecursionError:
        raise ValueError(_too_deep()) from None
    refuse_deep(data)
    return data


def refuse_deep(data: Any) -> None:
    """Raises ValueError for tables and lists too far within one another."""
    level = [data]
    for _ in range(DEEPEST + 1):
        level = [inner for outer in level for inner in _within(outer)]
        if not level:
            return
    raise ValueError(_too_deep())


def _within(value: Any) -> list[Any]:
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return [one for one in inner if isinstance(one, dict | list)]


def _too_deep() -> str:
    return f"tables within one another more than {DEEPEST} deep"
