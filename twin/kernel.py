"""How the hot functions are compiled: without the interpreter's lock, kept on disk under a hash of the sources.

numba's own cache looks at one file only and would go stale when a component that a kernel calls has changed; a
directory named by all sources cannot.
"""

from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numba.core import config

from twin.cache_folder import cache_directory
from twin.compiled_code import KernelCache

F = TypeVar("F", bound=Callable[..., Any])
FOLDER = cache_directory()
INTERPRETED = bool(config.DISABLE_JIT)  # pyright: ignore[reportAttributeAccessIssue] # as debuggers set it: slow

config.CACHE_DIR = str(FOLDER or "")  # pyright: ignore[reportAttributeAccessIssue]


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
    compiled = numba.njit(nogil=True, error_model="numpy", **options)(function)
    if FOLDER and not INTERPRETED:
        compiled._cache = KernelCache(function)  # pyright: ignore[reportAttributeAccessIssue]
    return compiled  # pyright: ignore[reportReturnType]
