"""A recording that a verb makes of a file: where it may go, what is there already, and that it appears as a whole."""

from pathlib import Path

from bridge.errors import UsageError
from bridge.recording.reader import Recording, read
from bridge.recording.replace import aside_of
from bridge.recording.writer import save

MCAP = ".mcap"


def is_replaced(path: Path, fact: str, verb: str) -> bool:
    """Will a file be replaced that the verb has made before?

    fact: record of facts that only its files have. Raises UsageError for a name that is not one of a recording, and for
    a file that is there and is not such a one.
    """
    if path.suffix != MCAP:
        raise UsageError(f"-o {path}: a recording is an MCAP file; name one that ends in {MCAP}")
    if not path.exists():
        return False
    if not (path.is_file() and _is_made(path, fact)):
        raise UsageError(f"-o {path}: is there and was not written by hydrotwin {verb}; name another file")
    return True


def _is_made(path: Path, fact: str) -> bool:
    try:
        return fact in read(path, (), growing=True).metadata
    except UsageError:
        return False


def save_whole(recording: Recording, path: Path, rig_name: str) -> Path:
    """Write a recording that is in memory; until it is complete nothing has changed. Raises UsageError."""
    with aside_of(path) as aside:
        save(recording, aside, rig_name)
    return path
