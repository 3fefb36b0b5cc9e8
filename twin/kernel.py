"""How the hot functions are compiled: without the interpreter's lock, kept on disk under a hash of the sources.

numba's own cache looks at one file only and would go stale when a component that a kernel calls has changed; a
directory named by all sources cannot.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core import config

F = TypeVar("F", bound=Callable[..., Any])


def cache_directory() -> Path:
    """Where compiled code of exactly these sources lives: the user's cache, or a temporary one if that is closed."""
    digest = hashlib.sha256()
    for package in ("twin", "controller"):
        for source in sorted((Path(__file__).parents[1] / package).rglob("*.py")):
            digest.update(source.read_bytes())
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    directory = home / "hydrotwin" / digest.hexdigest()[:16]
    try:
        directory.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=directory).close()
    except OSError:
        directory = Path(tempfile.gettempdir()) / f"hydrotwin-{os.getuid()}" / directory.name
    return directory


if not config.CACHE_DIR:  # pyright: ignore[reportAttributeAccessIssue]
    config.CACHE_DIR = str(cache_directory())  # pyright: ignore[reportAttributeAccessIssue]


def kernel(function: F) -> F:
    """Compile a function that the step calls: nogil, cached, and unable to allocate.

    Without numba's runtime for memory (`_nrt`) no array is counted on its way through the calls, which took half of
    the time of a step; and a kernel that allocates does not compile.
    """
    return _compiled(function, _nrt=False)


def inlined(function: F) -> F:
    """Compile a function as `kernel` does, to be copied into every kernel that calls it.

    numba hands a tuple over number by number, so a call costs as much as the equations of a small component: a function
    in the innermost loop that has few callers is better copied into them.
    """
    return _compiled(function, _nrt=False, forceinline=True)


def allocating_kernel(function: F) -> F:
    """Compile a function of the set-up that needs arrays of its own."""
    return _compiled(function)


def _compiled(function: F, **options: Any) -> F:
    options |= {"nogil": True, "cache": True, "error_model": "numpy"}
    return numba.njit(**options)(function)  # pyright: ignore[reportReturnType]
