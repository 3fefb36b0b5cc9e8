"""A shared library with a control law, as `hydrotwin_law.h` declares it: opened, and asked what it exports.

Every run opens a copy of its own, so that static variables are as fresh as the memory, and runs in one process do not
share them. A library that opens only where it stands, next to others that it needs, is opened there: then its static
variables stay from run to run.
"""

import ctypes
import os
import tempfile
from _ctypes import dlclose
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple
from weakref import finalize

from bridge.errors import ScenarioError

VERSION = 1  # HYDROTWIN_LAW_VERSION
MOST_MEMORY = 1_000_000  # numbers
MOST_NAMES = 1000
ADDRESS = ctypes.c_void_p
FUNCTIONS = {"": 7, "_init": 3, "_on_safe_state": 1, "_on_resume": 1}  # after PREFIX: how many pointers they take
PREFIX = "hydrotwin_law"
HOW = "cc -O2 -fPIC -shared"


class Code(NamedTuple):
    """A library before it is opened."""

    label: str  # for people: controller.library 'law.so'
    name: str  # of its file
    content: bytes
    place: Path | None  # where it stands; None for one that was compiled for us


class Signal(ctypes.Structure):
    """hydrotwin_signal."""

    _fields_ = (("name", ctypes.c_char_p), ("unit", ctypes.c_char_p))


class Exports(NamedTuple):
    """What a library says of its law."""

    memory: int  # numbers
    parameters: tuple[str, ...]
    signals: tuple[tuple[str, str], ...]  # name, unit
    functions: frozenset[str]  # of FUNCTIONS
    channels: tuple[str, ...] = ()  # further ones that it reads


class Library:
    """An open copy of a library; closed when nobody refers to it any more."""

    def __init__(self, code: Code) -> None:
        self.label = code.label
        self.handle = _open(code)
        finalize(self, dlclose, self.handle._handle).atexit = False

    def function(self, suffix: str) -> Any:
        """The function hydrotwin_law<suffix>; None where the library does not export it."""
        function = getattr(self.handle, PREFIX + suffix, None)
        if function is not None:
            function.argtypes = [ADDRESS] * FUNCTIONS[suffix]
            function.restype = None if suffix.startswith("_on") else ctypes.c_int
        return function

    def exports(self) -> Exports:
        """Raises ScenarioError for a library without a law, and for one of another version of the header."""
        version = self._number("_version")
        if version is None:
            raise self.refused(f"exports no {PREFIX}_version, so it is not a law: include hydrotwin_law.h")
        if version != VERSION:
            raise self.refused(f"is of version {version} of hydrotwin_law.h, this is {VERSION}: compile it again")
        found = frozenset(suffix for suffix in FUNCTIONS if self.function(suffix) is not None)
        if "" not in found:
            raise self.refused(f"exports no function {PREFIX}: define it as hydrotwin_law.h declares it")
        memory = self._number("_memory") or 0
        if not 0 <= memory <= MOST_MEMORY:
            raise self.refused(f"asks for {memory} numbers of memory: {PREFIX}_memory is 0 to {MOST_MEMORY}")
        entries = self._list(Signal, "_signals")
        signals = tuple((self._name(s.name), (s.unit or b"").decode("utf-8", "replace")) for s in entries)
        parameters, channels = (self._names(what) for what in ("_parameters", "_channels"))
        return Exports(memory, parameters, signals, found, channels)

    def refused(self, words: str) -> ScenarioError:
        """An error about this library."""
        return ScenarioError(f"{self.label} {words}")

    def _number(self, suffix: str) -> int | None:
        with suppress(ValueError):
            return ctypes.c_int32.in_dll(self.handle, PREFIX + suffix).value
        return None

    def _names(self, suffix: str) -> tuple[str, ...]:
        return tuple(self._name(entry.value) for entry in self._list(ctypes.c_char_p, suffix))

    def _list(self, kind: Any, suffix: str) -> list[Any]:
        """The entries of an exported list up to its end, which is a null."""
        try:
            first = ctypes.addressof(kind.in_dll(self.handle, PREFIX + suffix))
        except ValueError:
            return []
        found = []
        for place in range(MOST_NAMES):
            entry = kind.from_address(first + place * ctypes.sizeof(kind))
            if (entry.name if kind is Signal else entry.value) is None:
                return found
            found.append(entry)
        raise self.refused(f"has a list {PREFIX}{suffix} without an end: put a null behind its last entry")

    def _name(self, text: bytes) -> str:
        name = text.decode("utf-8", "replace")
        if not (name.isascii() and name.isidentifier()):
            raise self.refused(f"has a name {name!r:.80}: names are letters, digits and _, not a digit first")
        return name


def _open(code: Code) -> ctypes.CDLL:
    """Raises ScenarioError."""
    try:
        return _copy(code.content)
    except OSError as error:
        words = str(error)
    if code.place is not None:
        try:
            return ctypes.CDLL(str(code.place.resolve()))
        except OSError as error:
            words = str(error).removeprefix(f"{code.place.resolve()}: ")
    words = " ".join(words.split())
    raise ScenarioError(f"{code.label} cannot be loaded: {words}; give a shared library for this machine ({HOW})")


def _copy(content: bytes) -> ctypes.CDLL:
    """The library opened from a file of its own, which is gone at once: the system keeps what is open."""
    descriptor, path = tempfile.mkstemp(prefix="hydrotwin-law-", suffix=".so")
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
        return ctypes.CDLL(path)
    finally:
        os.unlink(path)
