"""A control law in C: the functions of its library called as a law of ours, with a memory that is a buffer of ours.

A run's memory is an open copy of the library and its numbers: None opens a fresh one.
"""

import ctypes
import math
import struct
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import RunError, ScenarioError, nearest
from bridge.loop.c_compiler import compiled
from bridge.loop.library import Code, Exports, Library
from bridge.loop.parameters import PLACE
from bridge.scenario.controllers import InC
from controller.grid import NS
from controller.law import CGains, Sample
from controller.laws import ControlLaw, Hook, forget
from controller.reference import Target

SAMPLE = ("stamp_ns", "position", "velocity", "p1", "p2", "p3")  # hydrotwin_sample, as fields of Sample
TARGET = ("position", "velocity")  # hydrotwin_target
FACTS = ("sample_period", "limit", "overlap")  # hydrotwin_facts
HEAD = f"@q{len(SAMPLE) - 1}dP"  # behind the readings, where the further channels are
INPUTS = struct.Struct(f"{HEAD}{len(TARGET)}d")  # both, one behind the other
TARGET_AT = struct.calcsize(f"{HEAD}0d")
HOOKS = ("on_safe_state", "on_resume")


class Prepared(NamedTuple):
    """What every call is given beside sample and target."""

    parameters: dict[str, float]
    facts: Any  # array of double
    numbers: Any  # array of double, in the order of the library


def c_law(controller: InC) -> ControlLaw:
    """The law of a scenario's controller. Raises ScenarioError where it cannot be loaded."""
    code = _code(controller)
    first = [Library(code)]  # opened already: the first sample does not wait for it
    exports = first[0].exports()

    def answer(sample: Sample, target: Target, memory: "CRun | None", gains: Prepared) -> tuple[Any, ...]:
        run = CRun(_fresh(first, code), exports, gains) if memory is None else memory
        return run.answer(sample, target, gains), run, *run.signals()

    hooks = {name: _hook(name) if f"_{name}" in exports.functions else forget for name in HOOKS}
    return ControlLaw(
        answer, **hooks, prepare=_preparing(exports, code.label), name=code.name, channels=exports.channels
    )


def exports_of(controller: InC, gains: CGains) -> Exports:
    """What the library of a controller says of its law. Raises ScenarioError for numbers that do not fit it."""
    code = _code(controller)
    exports = Library(code).exports()
    _prepared(gains, exports, code.label)
    return exports


def _fresh(first: list[Library], code: Code) -> Library:
    """A copy of a library that no run has used, also for runs of several threads."""
    with suppress(IndexError):
        return first.pop()
    return Library(code)


def _code(controller: InC) -> Code:
    """The library of a controller, read or compiled."""
    name = controller.library or controller.source
    label = f"controller.{'library' if controller.library else 'source'} {name!r}"
    file = Path(name)
    if not file.is_file():
        raise ScenarioError(f"{label}: there is no such file beside the scenario or in {Path.cwd()}")
    try:
        if controller.library:
            return Code(label, file.name, file.read_bytes(), file)
        return Code(label, file.name, compiled(file.resolve(), label), None)
    except OSError as error:
        raise ScenarioError(f"{label}: {error.strerror}") from None


class CRun:
    """One run of a law: a copy of its library, and its memory."""

    def __init__(self, library: Library, exports: Exports, gains: Prepared) -> None:
        self._library = library
        self._law = library.function("")
        self.memory = (ctypes.c_double * exports.memory)()
        self._declared = exports.signals
        self._signals = (ctypes.c_double * len(exports.signals))()
        self._channels = exports.channels
        self._readings = (ctypes.c_double * len(exports.channels))()
        self._further = ctypes.addressof(self._readings) if exports.channels else 0
        self._inputs = ctypes.create_string_buffer(INPUTS.size)
        self._spool = ctypes.c_double()
        inputs = ctypes.addressof(self._inputs)
        self._from = inputs, inputs + TARGET_AT
        self._to = tuple(map(ctypes.addressof, (self.memory, self._spool, self._signals)))
        if "_init" in exports.functions:
            returned = library.function("_init")(gains.facts, gains.numbers, self.memory)
            if returned:
                raise RunError(f"{library.label}: hydrotwin_law_init returned {returned}")

    def answer(self, sample: Sample, target: Target, gains: Prepared) -> float:
        """The spool reference. Raises RunError for a law that fails or gives no number."""
        INPUTS.pack_into(self._inputs, 0, *sample[: len(SAMPLE)], self._further, *target[: len(TARGET)])
        self._readings[:] = [sample.channels[name] for name in self._channels]
        self._spool.value = math.nan
        returned = self._law(*self._from, gains.facts, gains.numbers, *self._to)
        spool = self._spool.value
        if returned:
            raise self._failed(f"returned {returned}", sample)
        if not math.isfinite(spool):
            raise self._failed(f"set spool to {spool}, or not at all,", sample)
        return spool

    def signals(self) -> list[dict[str, tuple[float, str]]]:
        """What the law logs with its last answer, if it logs anything."""
        if not self._declared:
            return []
        return [{name: (value, unit) for (name, unit), value in zip(self._declared, self._signals, strict=True)}]

    def told(self, hook: str) -> "CRun":
        """The same run, whose law has been told."""
        self._library.function(f"_{hook}")(self.memory)
        return self

    def _failed(self, words: str, sample: Sample) -> RunError:
        return RunError(f"{self._library.label} {words} at t = {sample.stamp_ns / NS:g} s")


def _hook(name: str) -> Hook:
    return lambda memory: None if memory is None else memory.told(name)


def _preparing(exports: Exports, label: str) -> Callable[[CGains], Prepared]:
    return lambda gains: _prepared(gains, exports, label)


def _prepared(gains: CGains, exports: Exports, label: str) -> Prepared:
    """The parameters in the library's order. Raises ScenarioError, a line per mistake."""
    given, known = gains.parameters, exports.parameters
    said = {name: nearest(name, known) if known else ", nor any other" for name in given if name not in known}
    wrong = [f"{PLACE}.{name}: {label} has none of this name{words}" for name, words in said.items()]
    wrong += [f"{PLACE}.{name}: {label} needs it" for name in known if name not in given]
    if wrong:
        raise ScenarioError("\n".join(wrong))
    facts = [getattr(gains, name) for name in FACTS]
    return Prepared(given, _doubles(facts), _doubles([given[name] for name in known]))


def _doubles(values: list[float]) -> Any:
    return (ctypes.c_double * len(values))(*values)
