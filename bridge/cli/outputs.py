"""Files that a verb writes beside its result: one that cannot be written does not keep the rest from being shown."""

from pathlib import Path

from bridge.cli.streams import complain
from bridge.errors import RunError, writing


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
