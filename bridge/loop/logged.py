"""The signals that a law logs: numbers under names of its own, with units, the same in every sample of a run."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from bridge.errors import RunError
from bridge.scenario.units import in_si
from bridge.wire.messages import TOPICS, field_names
from controller.grid import NS

MOST = 64  # signals of a law
LONGEST = 40  # characters of a name or a unit
TAKEN = ("time", "tick", *field_names(TOPICS["signals"].type))  # columns of every table


class Unit(NamedTuple):
    """How a signal is given and how it is kept."""

    given: str
    kept: str  # SI where it is a unit that we know
    factor: float  # from one to the other


class Logged:
    """The signals of one run of a law. The first sample says which there are."""

    def __init__(self, law: str) -> None:
        self.names: list[str] = []  # in the order of the first sample
        self.units: list[str] = []  # as the values are kept
        self._law = law
        self._units: dict[str, Unit] | None = None  # None before the first sample

    def take(self, given: Any, stamp: int) -> list[float]:
        """The values of a sample, None for one that logs nothing. Raises RunError for what does not fit."""
        if given is None:
            given = {}
        if not isinstance(given, Mapping):
            words = "signals are a dict of name: number, or name: (number, unit)"
            raise self._wrong(f"the signals at {_time(stamp)} are {in_words(given)}: {words}")
        if self._units is None:
            self._units = self._first(given, stamp)
            self.names = list(self._units)
            self.units = [unit.kept for unit in self._units.values()]
        if given.keys() != self._units.keys():
            raise self._wrong(self._other_names(given, stamp))
        return [self._value(name, given[name], unit, stamp) for name, unit in self._units.items()]

    def _first(self, given: Mapping[Any, Any], stamp: int) -> dict[str, Unit]:
        if len(given) > MOST:
            raise self._wrong(f"{len(given)} signals at {_time(stamp)} are too many: log at most {MOST}")
        for name in given:
            if not (isinstance(name, str) and name.isidentifier() and name.isascii() and len(name) <= LONGEST):
                valid = f"a name is letters, digits and _, at most {LONGEST}, such as 'integral'"
                raise self._wrong(f"signal {in_words(name)} at {_time(stamp)}: {valid}")
            if name in TAKEN:
                raise self._wrong(f"signal {name!r} at {_time(stamp)}: every message has a field of that name")
        return {name: self._unit(name, entry, stamp) for name, entry in given.items()}

    def _unit(self, name: str, entry: Any, stamp: int) -> Unit:
        unit = _parts(entry)[1]
        if not isinstance(unit, str) or len(unit) > LONGEST or not unit.isprintable():
            raise self._wrong(f"signal {name!r} at {_time(stamp)} has the unit {in_words(unit)}: give a text as 'V'")
        return Unit(unit, *in_si(unit))

    def _other_names(self, given: Mapping[Any, Any], stamp: int) -> str:
        units = self._units or {}
        missing = [name for name in units if name not in given]
        name, how = (missing[0], "is missing") if missing else (next(n for n in given if n not in units), "is new")
        first = f"the same signals as the first ({', '.join(units) or 'none'})"
        return f"signal {in_words(name)} {how} at {_time(stamp)}: every sample logs {first}; NaN is a value"

    def _value(self, name: str, entry: Any, unit: Unit, stamp: int) -> float:
        number, written = (entry, "") if type(entry) is float else _parts(entry)
        if written != unit.given:
            words = f"is in {in_words(written)} at {_time(stamp)} and was in {unit.given!r}: a unit stays the same"
            raise self._wrong(f"signal {name!r} {words}")
        if (value := number_of(number)) is None:
            words = f"is {in_words(number)} at {_time(stamp)}: give a number, or (number, unit)"
            raise self._wrong(f"signal {name!r} {words}")
        return value * unit.factor

    def _wrong(self, words: str) -> RunError:
        return RunError(f"controller.law {self._law!r}: {words}")


def _parts(entry: Any) -> tuple[Any, Any]:
    """Number and unit of a signal as a law gives it."""
    return tuple(entry) if isinstance(entry, tuple | list) and len(entry) == 2 else (entry, "")


def number_of(value: Any) -> float | None:
    """A number as a float; None for what is not one: a text, an array, nothing."""
    if type(value) is float:
        return value
    if isinstance(value, int | float | np.number | np.bool_) and not isinstance(value, np.complexfloating):
        try:
            return float(value)
        except OverflowError:
            return None
    return None


def in_words(value: Any) -> str:
    """A user's value in a sentence: in one line, and cut where it is long."""
    try:
        text = " ".join(repr(value).split())
    except Exception:
        text = f"an object of type {type(value).__name__}"
    return text if len(text) <= 80 else f"{text[:77]}.."


def _time(stamp: int) -> str:
    return f"t = {stamp / NS:g} s"
