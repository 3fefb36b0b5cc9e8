"""Kernels as native code that runs without numba: kept on disk, loaded by LLVM alone, called with addresses.

The import of numba takes longer than all that a process does which only runs what was compiled before. The code of a
kernel takes its arguments one by one, an array as seven or more numbers; a caller, compiled with it, takes all of them
from a row of 8-byte slots, of which a call rewrites only those of the arguments that changed.
"""

import ctypes
import importlib
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple, NoReturn, TypeVar

import numpy as np
from llvmlite import binding

from twin.sealed_files import Files

T = TypeVar("T")
CALLER = "call_from_slots"
RESULT, ERROR, FIRST = 0, 1, 2  # slots: the result, numba's word on an exception, the first argument


class NativeCode(NamedTuple):
    """What is kept of a kernel for arguments of certain kinds."""

    function: bytes  # object code, of numba
    caller: bytes  # object code of CALLER
    needed: tuple[str, ...]  # symbols that the process must have
    returns: bool  # a number


def kinds(value: Any) -> Any:
    """All that numba's type of an argument depends on."""
    if isinstance(value, np.ndarray):
        return _written(value.dtype), value.ndim, value.flags.writeable
    if isinstance(value, tuple):
        return type(value).__qualname__, *map(kinds, value)
    return type(value).__name__


@cache
def _written(dtype: np.dtype[Any]) -> str:
    """A type of numbers or records in words; those of the plant take half a millisecond."""
    return str(dtype)


def kept(folder: Path | None, name: str, examples: tuple[Any, ...], make: Callable[[], T]) -> T:
    """What was made of a kernel for arguments like the examples, from disk where it is there and whole, or made."""
    if folder is None:
        return make()
    processor = binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()
    files, key = Files(folder / "native", name, processor), kinds(examples)
    found = files.load(key)
    if found is None:
        found = make()
        with suppress(OSError):
            files.folder.mkdir(parents=True, exist_ok=True)
            files.save(key, found)
    return found


@cache
def _initialize() -> None:
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()


def machine() -> binding.TargetMachine:
    """LLVM's idea of this computer."""
    _initialize()
    return binding.Target.from_default_triple().create_target_machine(codemodel="jitdefault", jit=True)


class Loaded:
    """Native code in memory."""

    def __init__(self, code: NativeCode) -> None:
        self.returns = code.returns
        self._engine = binding.create_mcjit_compiler(binding.parse_assembly(""), machine())
        if not all(map(binding.address_of_symbol, code.needed)):  # as far as they are not numba's own
            self._numba = importlib.import_module("numba.core.registry").cpu_target.target_context  # makes them known
        for part in (code.function, code.caller):
            self._engine.add_object_file(binding.ObjectFileRef.from_data(part))
        self._engine.finalize_object()
        self.call = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p)(self._engine.get_function_address(CALLER))


class Entry:
    """A loaded kernel and its arguments in their slots; for one thread at a time.

    Arrays must be contiguous, and all arguments of the kinds of the examples: TypeError otherwise.
    """

    def __init__(self, loaded: Loaded, examples: tuple[Any, ...]) -> None:
        self._loaded = loaded  # in memory as long as this
        self.call, self._returns = loaded.call, loaded.returns
        self._kinds = [*map(kinds, examples)]
        self._last: list[Any] = [None] * len(examples)
        sizes = [len([*numbers_of(example)]) for example in examples]
        self.begins = [FIRST + sum(sizes[:place]) for place in range(len(sizes))]
        slots = (ctypes.c_int64 * (FIRST + sum(sizes)))()
        self.whole: Any = memoryview(slots).cast("B").cast("q")
        self.floats: Any = memoryview(slots).cast("B").cast("d")
        self.address = ctypes.c_void_p(ctypes.addressof(slots))  # a whole number would be made into one at every call
        for place, example in enumerate(examples):
            self.put(place, example)

    def __call__(self, *arguments: Any) -> Any:
        for place, argument in enumerate(arguments):
            if argument is not self._last[place]:
                self.put(place, argument)
        return self.run()

    def put(self, place: int, argument: Any) -> None:
        """Write an argument into its slots, for all further runs."""
        begin, kind = self.begins[place], self._kinds[place]
        if kind in ("float", "int"):
            (self.floats if kind == "float" else self.whole)[begin] = argument
        elif kinds(argument) != kind:
            raise TypeError(f"argument {place} is {kinds(argument)}, not {kind}")
        else:
            for slot, number in zip(count(begin), numbers_of(argument)):
                (self.floats if isinstance(number, float) else self.whole)[slot] = number
        self._last[place] = argument

    def run(self) -> Any:
        """Call the kernel with what its slots hold."""
        if self.call(self.address):
            self.failed()
        return self.floats[RESULT] if self._returns else None

    def failed(self) -> NoReturn:
        """What a call of a kernel that does not return 0 has to say."""
        raise RuntimeError("the kernel has raised an exception")


def numbers_of(value: Any) -> Iterator[float]:
    """An argument as numba's code takes it, number by number."""
    if isinstance(value, np.ndarray):
        if not value.flags.c_contiguous:
            raise TypeError("an array that is not contiguous")
        yield from (0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides)
    elif isinstance(value, tuple):
        for entry in value:
            yield from numbers_of(entry)
    else:
        yield value
