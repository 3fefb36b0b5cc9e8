"""Which signal of a drive a column may be: by the words of its name, in English and German, and by its unit."""

import re
from enum import IntEnum
from itertools import pairwise
from typing import NamedTuple

from bridge.recording.logs.headers import factor
from bridge.recording.logs.map import COMMAND, REFERENCE
from bridge.recording.logs.table import Column
from twin.topology import CHANNELS

PARTS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[äöüß]+", re.UNICODE)


class Sure(IntEnum):
    """How sure a guess is."""

    UNSURE = 0
    LIKELY = 1
    SURE = 2
    OWN = 3  # it is named as we name it

    @property
    def word(self) -> str:
        """For people."""
        return min(self, Sure.SURE).name.lower()


class Kind(NamedTuple):
    """A signal, and how loggers call it."""

    signal: str
    si: tuple[str, ...]  # units it may have; "" is none
    words: frozenset[str]  # whole words of a name
    letters: frozenset[str] = frozenset()  # weaker: one letter, or a short mark


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


LENGTH, SPEED, PRESSURE, FORCE = ("m", ""), ("m/s", ""), ("Pa", ""), ("N",)
ELECTRIC = ("", "V", "A")
KINDS = (  # in the order in which they are tried
    Kind(
        REFERENCE,
        LENGTH,
        _words("reference ref setpoint target soll sollwert sollposition sollweg desired demand"),
    ),
    Kind(
        COMMAND,
        ELECTRIC,
        _words("command cmd valve ventil control controller stellgroesse stellgröße stellsignal spoolref drive output"),
        _words("u uv"),
    ),
    Kind("spool", ELECTRIC, _words("spool schieber lvdt"), _words("y")),
    Kind("velocity", SPEED, _words("velocity speed geschwindigkeit vel tacho tachometer"), _words("v")),
    Kind(
        "position",
        LENGTH,
        _words("position pos weg way stroke displacement hub lage travel piston kolben kolbenweg istposition cylinder"),
        _words("x s"),
    ),
    Kind("acceleration", ("m/s^2",), _words("acceleration acc accel beschleunigung"), _words("a")),
    Kind("force", FORCE, _words("force kraft load last cell"), _words("f")),
    Kind("p_t", PRESSURE, _words("tank return ruecklauf rücklauf tankdruck"), _words("t pt r")),
    Kind("p2", PRESSURE, _words("cap kolbenseite bore head bottom boden"), _words("a pa")),
    Kind("p3", PRESSURE, _words("rod stange stangenseite ring ringseite annulus"), _words("b pb")),
    Kind(  # the last: its letter p is in the name of every pressure
        "p_p",
        PRESSURE,
        _words("supply pump pumpe versorgung system sys source druckversorgung speisedruck"),
        _words("p0 ps pp s p"),
    ),
)
BOOKKEEPING = _words("sequence seq counter index stamp timestamp tick ticks id zaehler zähler")  # never a signal
OWN_BOOKKEEPING = ("command.source", "command.apply_at")  # of our messages; elsewhere a source is one of pressure
SAID_PRESSURE = frozenset(("p", "pressure", "press", "druck"))  # where no unit says so


def parts_of(name: str) -> list[str]:
    """The words of a name: of CamelCase, snake_case and whatever stands between; one letter of pressures, too."""
    return [part.lower() for part in PARTS.findall(name)]


def candidates(column: Column) -> list[tuple[str, Sure, str]]:
    """Signals that a column may be, the likeliest first, each with how sure that is and why."""
    si = factor(column.unit)[0] if column.unit else ""
    group, _, own = column.name.partition(".")
    if group == "measurement" and own in CHANNELS:
        return [(own, Sure.OWN, "named as `hydrotwin export` does")]
    words = parts_of(_without_unit(column))
    if BOOKKEEPING & set(words) or column.name.endswith(OWN_BOOKKEEPING):
        return []
    pairs = {a + b for a, b in pairwise(words)}
    fits = f" and unit {column.unit}" if si else ", no unit"
    found = []
    for kind in KINDS:
        if si not in kind.si or (kind.si == PRESSURE and not si and not SAID_PRESSURE & set(words)):
            continue
        if hit := next((word for word in words if word in kind.words), None):
            found.append((kind.signal, Sure.SURE if si else Sure.LIKELY, f"name {hit!r}{fits}"))
        elif hit := next((word for word in (*words, *sorted(pairs)) if word in kind.letters), None):
            found.append((kind.signal, Sure.LIKELY if si else Sure.UNSURE, f"letter {hit!r}{fits}"))
    return sorted(found, key=lambda entry: -entry[1])


def _without_unit(column: Column) -> str:
    """The name without an ending that is its unit: the s of time_s is not a letter of the name."""
    if not column.unit:
        return column.name
    ends = [column.unit, column.unit.replace(" ", "_"), column.unit.replace("/", "_").replace("^", "")]
    return next(
        (column.name[: -len(end)] for end in ends if column.name.lower().endswith(f"_{end.lower()}")), column.name
    )
