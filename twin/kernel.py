"""How the hot functions are compiled: without the interpreter's lock, kept on disk under a hash of the sources.

numba's own cache looks at one file only and would go stale when a component that a kernel calls has changed; a
directory named by all sources cannot. numba is imported when something must be compiled, and not before: its import
takes longer than the rest of a start.
"""

import inspect
import os
from collections.abc import Callable
from contextvars import ContextVar
from functools import cache, cached_property, update_wrapper
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar, get_args, get_type_hints

from twin.cache_folder import cache_directory
from twin.native_code import Entry, Loaded, NativeCode, kept, kinds

F = TypeVar("F", bound=Callable[..., Any])
P = ParamSpec("P")
R = TypeVar("R")
FOLDER = cache_directory()
INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")  # as debuggers set it: slow

COMMON: dict[str, Any] = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
LEAN: dict[str, Any] = COMMON | {"_nrt": False}
COPIED: Any = LEAN | {"forceinline": True, "no_cpython_wrapper": True}


def copies() -> Path | None:
    """Where functions are kept that kernels copy. Python cannot call these, so they stand apart."""
    return FOLDER and FOLDER / "copied"


def kernel(function: F) -> F:
    """Compile a function that the step calls: nogil, cached, and unable to allocate.

    Without numba's runtime for memory (`_nrt`) no array is counted on its way through the calls, which took half of
    the time of a step; and a kernel that allocates does not compile.
    """
    return _compiled(function, **LEAN)


def entry(function: Callable[..., Any], *examples: Any) -> Callable[..., Any]:
    """The code of a kernel for arguments of the types of some examples, for one thread at a time.

    It is found without numba where it was compiled before. Arrays must be contiguous, as the examples are; what the
    kernel returns is None or a number.
    """
    if INTERPRETED:
        return function
    return Entry(_loaded(function, Alike(examples)), examples)


_interpreting: ContextVar[bool] = ContextVar("interpreting", default=False)


def interpreted(function: F) -> F:
    """The source of a kernel, for a few calls from Python: cheaper than numba's import, and as slow as Python.

    What it calls is interpreted, too.
    """
    source: Any = function.py_func  # pyright: ignore[reportFunctionMemberAccess]

    def call(*arguments: Any, **named: Any) -> Any:
        before = _interpreting.set(True)
        try:
            return source(*arguments, **named)
        finally:
            _interpreting.reset(before)

    return call  # pyright: ignore[reportReturnType]


class Alike:
    """Examples that are equal when numba sees the same types in them."""

    def __init__(self, examples: tuple[Any, ...]) -> None:
        self.examples = examples
        self._kinds = kinds(examples)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Alike) and self._kinds == other._kinds

    def __hash__(self) -> int:
        return hash(self._kinds)


def module_of(function: Any, *examples: Any) -> bytes:
    """The module of LLVM, as bitcode, that the code of a kernel for arguments of the types of some examples is made of.

    It was optimised for this processor, and gives the same bits on another one, but for its library of mathematics.
    """
    return kept(FOLDER, _module_name(function), examples, lambda: _compiled_for(function, examples)[1])


@cache
def _loaded(function: Any, alike: Alike) -> Loaded:
    def make() -> NativeCode:
        code, module = _compiled_for(function, alike.examples)
        kept(FOLDER, _module_name(function), alike.examples, lambda: module)
        return code

    return Loaded(kept(FOLDER, _full_name(function), alike.examples, make))


def _full_name(function: Any) -> str:
    return f"{function.__module__}.{function.__qualname__}"


def _module_name(function: Any) -> str:
    return f"{_full_name(function)}.module"


def _compiled_for(function: Any, examples: tuple[Any, ...]) -> tuple[NativeCode, bytes]:
    from twin.compiler import native_code

    return native_code(function.py_func, examples, **function.options)


class _Kernel:
    """A function that numba compiles when Python or another kernel first calls it."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        self.py_func = function
        self.options = options
        update_wrapper(self, function)

    @cached_property
    def compiled(self) -> Any:
        """numba's function."""
        from twin.compiler import compiled_function

        return compiled_function(self.py_func, FOLDER, self.options)

    @cached_property
    def _numba_type_(self) -> Any:
        """What numba sees where a kernel calls this one."""
        return self.compiled._numba_type_

    def __reduce__(self) -> str:
        return self.__qualname__  # pyright: ignore[reportAttributeAccessIssue] # pickled by name, as a function

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        return (self.py_func if _interpreting.get() else self.compiled)(*arguments, **named)


def inlined(function: F) -> F:
    """Compile a function as `kernel` does, to be copied into every kernel that calls it.

    numba hands a tuple over number by number, so a call costs as much as the equations of a small component: a function
    in the innermost loop that has few callers is better copied into them. It is compiled once for its types and kept on
    disk, so another combination of kinds compiles those functions only that see what has changed.
    """
    if INTERPRETED:
        return _plain(function)
    return _Inlined(function, LEAN)  # pyright: ignore[reportReturnType]


class _Inlined(_Kernel):
    """A function that kernels copy and Python may call.

    The way in from Python is a quarter of numba's work on a small function, so it is made when Python first calls.
    """

    @cached_property
    def _numba_type_(self) -> Any:
        from twin.compiler import chosen_when_compiled

        return chosen_when_compiled(self, lambda *_, **__: self.py_func, copies(), COPIED)


def by_type(general: Callable[P, R]) -> "ByType[P, R]":
    """Choose a function by the type of its first argument, a NamedTuple, when its caller is compiled.

    As `functools.singledispatch`, which chooses at every call: variants are added with `register`, and what is not
    chosen is not in the compiled code. So a component that may or may not be fitted costs nothing where it is not.
    """
    return ByType(general)


class ByType(Generic[P, R]):
    """A function with a variant for each type of its first argument."""

    def __init__(self, general: Callable[P, R]) -> None:
        self._variants: dict[type, Callable[..., R]] = {}
        update_wrapper(self, general)

    @cached_property
    def _numba_type_(self) -> Any:
        from twin.compiler import chosen_when_compiled

        return chosen_when_compiled(self, self._source, copies(), COPIED)

    def __call__(self, *arguments: P.args, **_: P.kwargs) -> R:
        return self._variant(arguments[0])(*arguments)

    def py_func(self, *arguments: P.args, **_: P.kwargs) -> R:
        """The source of the variant, as `interpreted` finds it."""
        return interpreted(self._variant(arguments[0]))(*arguments)

    def _variant(self, first: Any) -> Callable[..., R]:
        if variant := self._variants.get(type(first)):
            return variant
        for kind, variant in self._variants.items():
            if isinstance(first, kind) or _names(first) == field_names(kind):
                return variant
        raise TypeError(f"{self.__name__} is not defined for {first!r}")  # pyright: ignore[reportAttributeAccessIssue]

    def register(self, variant: Callable[..., R]) -> Callable[..., R]:
        """Add the variant for the annotated type of its first argument, or for each of a union of types."""
        first = next(iter(inspect.signature(variant).parameters))
        annotated = get_type_hints(variant)[first]
        for kind in get_args(annotated) or (annotated,):
            if any(field_names(kind) == field_names(other) for other in self._variants):
                raise TypeError(
                    f"{kind.__name__} has the fields of another variant: a record could not tell them apart"
                )
            self._variants[kind] = inlined(variant)
        return variant

    def _source(self, *arguments: Any) -> Callable[..., Any] | None:
        """The variant for numba's types: a NamedTuple knows its class, a record the names of its fields."""
        first = arguments[0]
        fields = tuple(getattr(first, "fields", ()))
        for kind, variant in self._variants.items():
            if getattr(first, "instance_class", None) is kind or fields == field_names(kind):
                return variant.py_func  # pyright: ignore[reportFunctionMemberAccess]
        return None


class _Rows:
    """`rows`, whose compiled code calls nothing of numba's, as `reshape` does."""

    __name__ = "rows"

    def __call__(self, flat: Any, count: int, width: int) -> Any:
        return flat.reshape(count, width)

    @cached_property
    def _numba_type_(self) -> Any:
        from twin.compiler import type_of_rows

        return type_of_rows(self)


rows = _Rows()  # (flat, count, width): a contiguous array as a view of `count` rows


def field_names(kind: type) -> tuple[str, ...]:
    """Names of the fields of a NamedTuple in a record; one that has none is marked by its own name."""
    return kind._fields or (kind.__name__,)  # pyright: ignore[reportAttributeAccessIssue]


def _names(value: Any) -> tuple[str, ...] | None:
    """Names of the fields of a record that Python reads."""
    return value.dtype.names if hasattr(value, "dtype") else None


def allocating_kernel(function: F) -> F:
    """Compile a function of the set-up that needs arrays of its own."""
    return _compiled(function, **COMMON)


def _compiled(function: F, **options: Any) -> F:
    return _plain(function) if INTERPRETED else _Kernel(function, options)  # pyright: ignore[reportReturnType]


def _plain(function: F) -> F:
    """The function itself, which is its own source."""
    vars(function)["py_func"] = function
    return function
