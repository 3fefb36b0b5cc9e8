"""How the hot functions are compiled: without the interpreter's lock, kept on disk under a hash of the sources.

numba's own cache looks at one file only and would go stale when a component that a kernel calls has changed; a
directory named by all sources cannot.
"""

import inspect
from collections.abc import Callable
from functools import update_wrapper
from typing import Any, Generic, ParamSpec, TypeVar, get_type_hints

import numba
from numba.core import config, types
from numba.extending import overload

from twin.cache_folder import cache_directory
from twin.compiled_code import KernelCache

F = TypeVar("F", bound=Callable[..., Any])
P = ParamSpec("P")
R = TypeVar("R")
FOLDER = cache_directory()
INTERPRETED = bool(config.DISABLE_JIT)  # pyright: ignore[reportAttributeAccessIssue] # as debuggers set it: slow

LEAN: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}
COPIED: Any = LEAN | {"forceinline": True, "no_cfunc_wrapper": True}  # kept on disk as part of what calls them

config.CACHE_DIR = str(FOLDER or "")  # pyright: ignore[reportAttributeAccessIssue]


def kernel(function: F) -> F:
    """Compile a function that the step calls: nogil, cached, and unable to allocate.

    Without numba's runtime for memory (`_nrt`) no array is counted on its way through the calls, which took half of
    the time of a step; and a kernel that allocates does not compile.
    """
    return _compiled(function, **LEAN)


def entry(function: Callable[..., Any], *examples: Any) -> Callable[..., Any]:
    """The code of a kernel for arguments of the types of some examples, without numba's look at them at every call.

    The look at eight arguments takes as long as a step of the plant. Arrays must be contiguous, as the examples are.
    """
    if INTERPRETED:
        return function
    return function.compile(tuple(map(numba.typeof, examples)))  # pyright: ignore[reportFunctionMemberAccess]


def inlined(function: F) -> F:
    """Compile a function as `kernel` does, to be copied into every kernel that calls it.

    numba hands a tuple over number by number, so a call costs as much as the equations of a small component: a function
    in the innermost loop that has few callers is better copied into them.
    """
    return _Inlined(function)  # pyright: ignore[reportReturnType]


class _Inlined:
    """A function that kernels copy and Python may call.

    The way in from Python is a quarter of numba's work on a small function, so it is made when Python first calls.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.py_func = function
        self._from_python: Callable[..., Any] | None = None
        update_wrapper(self, function)
        overload(self, jit_options=COPIED, strict=False)(lambda *_, **__: function)

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        if self._from_python is None:
            self._from_python = _compiled(self.py_func, **LEAN)
        return self._from_python(*arguments, **named)


def by_type(general: Callable[P, R]) -> "ByType[P, R]":
    """Choose a function by the type of its first argument, a NamedTuple, when its caller is compiled.

    As `functools.singledispatch`, which chooses at every call: variants are added with `register`, and what is not
    chosen is not in the compiled code. So a component that may or may not be fitted costs nothing where it is not.
    """
    return ByType(general)


class ByType(Generic[P, R]):
    """A function with a variant for each type of its first argument."""

    def __init__(self, general: Callable[P, R]) -> None:
        self._variants: dict[type, _Inlined] = {}
        update_wrapper(self, general)
        overload(self, jit_options=COPIED, strict=False)(self._source)

    def __call__(self, *arguments: P.args, **_: P.kwargs) -> R:
        first = arguments[0]
        for kind, variant in self._variants.items():
            if isinstance(first, kind) or _names(first) == field_names(kind):
                return variant(*arguments)
        raise TypeError(f"{self.__name__} is not defined for {first!r}")  # pyright: ignore[reportAttributeAccessIssue]

    def register(self, variant: Callable[..., R]) -> Callable[..., R]:
        """Add the variant for the annotated type of its first argument."""
        first = next(iter(inspect.signature(variant).parameters))
        kind = get_type_hints(variant)[first]
        if any(field_names(kind) == field_names(other) for other in self._variants):
            raise TypeError(f"{kind.__name__} has the fields of another variant: a record could not tell them apart")
        self._variants[kind] = _Inlined(variant)
        return variant

    def _source(self, *arguments: Any) -> Callable[..., Any] | None:
        """The variant for numba's types: a NamedTuple knows its class, a record the names of its fields."""
        first = arguments[0]
        for kind, variant in self._variants.items():
            if getattr(first, "instance_class", None) is kind:
                return variant.py_func
            if isinstance(first, types.Record) and tuple(first.fields) == field_names(kind):
                return variant.py_func
        return None


def field_names(kind: type) -> tuple[str, ...]:
    """Names of the fields of a NamedTuple in a record; one that has none is marked by its own name."""
    return kind._fields or (kind.__name__,)  # pyright: ignore[reportAttributeAccessIssue]


def _names(value: Any) -> tuple[str, ...] | None:
    """Names of the fields of a record that Python reads."""
    return value.dtype.names if hasattr(value, "dtype") else None


def allocating_kernel(function: F) -> F:
    """Compile a function of the set-up that needs arrays of its own."""
    return _compiled(function, nogil=True, error_model="numpy")


def _compiled(function: F, **options: Any) -> F:
    compiled = numba.njit(**options)(function)
    if FOLDER and not INTERPRETED:
        compiled._cache = KernelCache(function)  # pyright: ignore[reportAttributeAccessIssue]
    return compiled  # pyright: ignore[reportReturnType]
