"""Write a file as a whole: it appears under its name when it is complete, and never in part."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from bridge.errors import UsageError


@contextmanager
def whole_file(path: Path) -> Iterator[IO[bytes]]:
    """A file to write to that takes the place of `path` at the end; after an exception nothing has changed.

    Raises UsageError with one line where it cannot be written.
    """
    with aside_of(path) as aside, aside.open("wb") as file:
        yield file


@contextmanager
def aside_of(path: Path) -> Iterator[Path]:
    """An empty file that, once written, takes the place of `path`; the same otherwise."""
    target = path.resolve()
    if target.exists() and not target.is_file():
        raise UsageError(f"{path}: is not a file that can be replaced; name another one")
    aside = part_of(path)
    try:
        with suppress(FileExistsError):  # a file of that name: to open what lies in it says so better
            target.parent.mkdir(parents=True, exist_ok=True)
        aside.open("xb").close()
        yield aside
        aside.replace(target)
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; name another file with --output") from None
    finally:
        with suppress(OSError):
            aside.unlink()


def part_of(path: Path) -> Path:
    """What is written aside for a path, by this process."""
    target = path.resolve()
    return target.with_name(f".{target.name}.{os.getpid()}.part")
