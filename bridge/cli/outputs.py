"""What a verb hands over: JSON on standard output, and files beside it; one that cannot be written hides no result."""

import json
from pathlib import Path
from typing import Any

from bridge.cli.streams import complain
from bridge.errors import RunError, writing


def print_json(value: Any) -> None:
    """Plain JSON on standard output."""
    print(json.dumps(value, indent=2))


def write_text(path: Path | None, text: str) -> bool:
    """Write a text if there is a path for it; one line on standard error and False when that cannot be."""
    if path is None:
        return True
    try:
        with writing(path):
            path.write_text(text, encoding="utf-8")
    except RunError as error:
        complain(str(error))
        return False
    return True
