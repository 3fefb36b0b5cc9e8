"""What a verb hands over: JSON on standard output, and files beside it; one that cannot be written hides no result."""

import json
import math
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import Any

from bridge.cli.streams import complain
from bridge.errors import RunError, writing


def print_json(value: Any) -> None:
    """Plain JSON on standard output."""
    print(json_text(value))


def json_text(value: Any, indent: int | None = 2) -> str:
    """Plain JSON. It has no NaN and no infinity: such a number is null, as what is not known."""
    return json.dumps(_known(value), indent=indent, allow_nan=False)


def _known(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _known(held) for key, held in value.items()}
    return [*map(_known, value)] if isinstance(value, list | tuple) else value


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


@contextmanager
def to_write(output: Path | None, verb: str, name: str) -> Iterator[Path]:
    """A file to write: that which was named, or one in a folder of this call, which goes where nothing is found."""
    path = output or own_folder(verb) / name
    try:
        yield path
    except BaseException:
        if output is None:
            with suppress(OSError):
                path.parent.rmdir()
        raise


def own_folder(verb: str) -> Path:
    """runs/VERB-TIME, with -2, -3 and so on where another call has that; what cannot be made is told by the run."""
    wanted = Path("runs") / f"{verb}-{time.strftime('%Y%m%d-%H%M%S')}"
    for number in count(1):
        folder = wanted if number == 1 else wanted.with_name(f"{wanted.name}-{number}")
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            continue
        except OSError:
            return folder
        return folder
    raise AssertionError("unreachable")


def given_up(path: Path) -> str:
    """Of a verb that is interrupted while it makes a recording: nothing is left of it; what is said."""
    from bridge.recording.replace import part_of

    part_of(path).unlink(missing_ok=True)
    return f"interrupted; {path} is not written" + (", it is as it was before" if path.exists() else "")
