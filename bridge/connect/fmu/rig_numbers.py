"""The numbers of a rig that native code can change while it runs: found by building the circuit with them.

A number that `hydrotwin set` can change is taken where the circuit follows from it by plain arithmetic: its
expressions are traced, and compared with the circuit itself, bit for bit, over the range that the FMU then allows.
What changes the lines, or is found by a search or a fit, is left out.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from bridge.connect.fmu.trace import Traced
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of
from bridge.scenario.tunable import Tunable, tunables
from twin.circuit.build import rebuild
from twin.circuit.step import Circuit

NUDGE = 1e-9  # of a value: another number, whose parts no cache has
AWAY = (1.1, 2.0, 10.0, 100.0)  # times the value: how far its range is looked for
TOWARDS = (0.9, 0.5, 0.1, 0.0)
SIZES = (1e-9, 1e-6, 1e-3, 1.0, 1e2, 1e4, 1e6, 1e8)  # the same for a number that is 0
BEYOND = (ValueError, ZeroDivisionError, OverflowError, TypeError)  # what a rig raises that cannot be so
_HEX = re.compile(r"0x[0-9a-f.]+p[+-]\d+")
_NAME = re.compile(r"\{([^}]+)\}")

Values = dict[str, dict[str, Any]]
Flat = list[float]


class Range(NamedTuple):
    """A number and how far it may be changed."""

    number: Tunable
    low: float
    high: float


class Changes(NamedTuple):
    """What native code has to do when numbers change."""

    ranges: list[Range]
    entries: dict[int, str]  # place in the record of Parts: expression in C, a number as "{rig.load.force}"


def changes_of(scenario: Scenario) -> Changes:
    """The numbers of a scenario's rig that native code can change, and how."""
    circuit, values = circuit_of(scenario), scenario.rig_values()
    found = {name: entry for name, entry in tunables(scenario).items() if name.startswith("rig.")}
    names = [name for name in found if _is_traced(circuit, values, name)]
    while True:
        entries = _expressions(circuit, values, names)
        wrong = _wrong(circuit, values, names, entries)
        if not wrong:
            break
        names = [name for name in names if name not in wrong]
    native = _Native(circuit, values, entries)
    ranges = [Range(found[name], *_range(native, found[name])) for name in names]
    return Changes([found for found in ranges if found.low < found.high], entries)


def flat(value: Any) -> Flat:
    """A nested NamedTuple of floats as its record holds it; one without fields keeps a place."""
    if not isinstance(value, tuple):
        return [value]
    return [number for entry in value for number in flat(entry)] or [0.0]


def _with(values: Values, numbers: Mapping[str, float]) -> Values:
    changed = {part: dict(entries) for part, entries in values.items()}
    for name, number in numbers.items():
        _, part, key = name.split(".")
        changed[part][key] = number
    return changed


def _rebuilt(circuit: Circuit, values: Values, numbers: Mapping[str, float]) -> Circuit:
    """The circuit after changes one by one, as a run makes them."""
    for name in numbers:
        circuit = rebuild(circuit, _with(values, numbers), name.removeprefix("rig."))
    return circuit


def _nudged(values: Values, name: str, times: int = 1) -> float:
    _, part, key = name.split(".")
    value = float(values[part][key])
    return value * (1.0 + times * NUDGE) if value else times * NUDGE


def _is_traced(circuit: Circuit, values: Values, name: str) -> bool:
    """Does a number act on the parts alone, and by expressions that hold for other values of it?"""
    value, before = _nudged(values, name), flat(circuit.parts)
    try:
        then = _rebuilt(circuit, values, {name: value})
        if then.lines is not circuit.lines:
            return False
        followed = flat(_rebuilt(circuit, values, {name: Traced(value, f"{{{name}}}")}).parts)
    except BEYOND:
        return False
    moved = [place for place, (a, b) in enumerate(zip(before, flat(then.parts), strict=True)) if not _same(a, b)]
    entries = {place: number.expression for place, number in enumerate(followed) if isinstance(number, Traced)}
    native = _Native(circuit, values, entries)
    return bool(moved) and set(moved) <= set(entries) and all(map(native.agrees, _tries(values, name)))


def _tries(values: Values, name: str) -> Iterator[dict[str, float]]:
    """The number as it is, and a little off."""
    _, part, key = name.split(".")
    value = float(values[part][key])
    for share in (0.0, 1e-3, 7e-3, -1e-3):
        yield {name: value * (1.0 + share) if value else share}


def _expressions(circuit: Circuit, values: Values, names: list[str]) -> dict[int, str]:
    """Of the record's entries that depend on numbers, all of them traced at once."""
    traced = {name: Traced(_nudged(values, name, k), f"{{{name}}}") for k, name in enumerate(names, 1)}
    parts: dict[str, str] = {}
    for name in names:
        parts.setdefault(name.split(".")[1], name)
    then = circuit
    for name in parts.values():
        then = rebuild(then, _with(values, traced), name.removeprefix("rig."))
    return {place: value.expression for place, value in enumerate(flat(then.parts)) if isinstance(value, Traced)}


class _Native:
    """What native code makes of numbers, and the circuit that a run would have."""

    def __init__(self, circuit: Circuit, values: Values, entries: dict[int, str]) -> None:
        self.circuit, self.values = circuit, values
        self._before = flat(circuit.parts)
        self._entries = {place: evaluator(expression) for place, expression in entries.items()}

    def agrees(self, numbers: Mapping[str, float]) -> bool:
        """Bit for bit? False for numbers that the rig cannot have."""
        try:
            return not self.differing(numbers)
        except BEYOND:
            return False

    def differing(self, numbers: Mapping[str, float]) -> list[int]:
        """The places in the record that native code would get wrong."""
        changed, found = _with(self.values, numbers), list(self._before)
        for place, value in self._entries.items():
            found[place] = value(changed)
        true = flat(_rebuilt(self.circuit, self.values, numbers).parts)
        return [place for place, pair in enumerate(zip(found, true, strict=True)) if not _same(*pair)]


def evaluator(expression: str) -> Callable[[Values], float]:
    """What an expression gives for the numbers of a rig."""
    text = _HEX.sub(lambda match: repr(float.fromhex(match[0])), expression)
    text = _NAME.sub(lambda match: "float(values[{!r}][{!r}])".format(*match[1].split(".")[1:]), text)
    names = {"fabs": abs, "pow": float.__pow__, "float": float, "NAN": float("nan"), "INFINITY": float("inf")}
    return eval(f"lambda values: {text}", {"__builtins__": {}} | names)


def _wrong(circuit: Circuit, values: Values, names: list[str], entries: dict[int, str]) -> set[str]:
    """Numbers that native code would get wrong together: those of the first expression that does not hold."""
    native = _Native(circuit, values, entries)
    together: dict[str, float] = {}
    for name in names:
        together |= list(_tries(values, name))[1]
        for place in native.differing(together):
            return {*_NAME.findall(entries.get(place, ""))} or {name}
    return set()


def _range(native: _Native, entry: Tunable) -> tuple[float, float]:
    """How far a number may go, each value on the way tried."""
    least = -float("inf") if entry.low is None else entry.low
    most = float("inf") if entry.high is None else entry.high
    ends = []
    for probes in _probes(entry.value):
        reached = entry.value
        for probe in sorted({min(max(probe, least), most) for probe in probes}, key=lambda p: abs(p - entry.value)):
            if not native.agrees({entry.name: probe}):
                break
            reached = probe
        ends.append(reached)
    return min(ends), max(ends)


def _probes(value: float) -> Iterator[list[float]]:
    """Values on either side of a number."""
    if value == 0.0:
        yield [-size for size in SIZES]
        yield list(SIZES)
        return
    yield [value * factor for factor in AWAY]
    yield [value * factor for factor in TOWARDS] + [-value * factor for factor in (1.0, *AWAY)]


def _same(a: float, b: float) -> bool:
    return a == b or (a != a and b != b)
