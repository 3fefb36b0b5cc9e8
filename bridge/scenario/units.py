"""Numbers with units: what a person may write where SI is kept."""

import math
import re
from typing import NamedTuple

from bridge.errors import UsageError, nearest


class Unit(NamedTuple):
    """value_SI = factor * value + offset."""

    factor: float
    offset: float = 0.0


MINUTE = 60.0
LONGEST = 200  # characters of a number with its unit
LARGEST = 1e15  # of an option, in SI: above it nothing is meant
UNITS: dict[str, dict[str, Unit]] = {
    "s": {"s": Unit(1.0), "ms": Unit(1e-3), "us": Unit(1e-6), "ns": Unit(1e-9), "min": Unit(MINUTE), "h": Unit(3600.0)},
    "m": {"m": Unit(1.0), "cm": Unit(1e-2), "mm": Unit(1e-3), "um": Unit(1e-6)},
    "m/s": {"m/s": Unit(1.0), "mm/s": Unit(1e-3)},
    "m^2/s": {"m^2/s": Unit(1.0), "mm^2/s": Unit(1e-6), "cSt": Unit(1e-6)},
    "m^3": {"m^3": Unit(1.0), "l": Unit(1e-3), "cm^3": Unit(1e-6)},
    "m^3/s": {"m^3/s": Unit(1.0), "l/min": Unit(1e-3 / MINUTE), "l/s": Unit(1e-3)},
    "Pa": {"Pa": Unit(1.0), "kPa": Unit(1e3), "MPa": Unit(1e6), "GPa": Unit(1e9), "bar": Unit(1e5)},
    "Pa s/m^3": {"Pa s/m^3": Unit(1.0), "bar s/m^3": Unit(1e5), "bar/(l/min)": Unit(1e5 * MINUTE / 1e-3)},
    "m^3/(s Pa)": {
        "m^3/(s Pa)": Unit(1.0),
        "m^3/(s bar)": Unit(1e-5),
        "l/(min bar)": Unit(1e-3 / MINUTE / 1e5),
    },
    "m^2": {"m^2": Unit(1.0), "cm^2": Unit(1e-4), "mm^2": Unit(1e-6)},
    "kg m^2": {"kg m^2": Unit(1.0), "kg cm^2": Unit(1e-4)},
    "N s^2/m^2": {"N s^2/m^2": Unit(1.0)},
    "kg": {"kg": Unit(1.0), "g": Unit(1e-3), "t": Unit(1e3)},
    "kg/m^3": {"kg/m^3": Unit(1.0), "g/cm^3": Unit(1e3)},
    "m/s^2": {"m/s^2": Unit(1.0)},
    "N": {"N": Unit(1.0), "kN": Unit(1e3)},
    "N s": {"N s": Unit(1.0)},
    "N/m": {"N/m": Unit(1.0), "kN/m": Unit(1e3), "N/mm": Unit(1e3)},
    "N s/m": {"N s/m": Unit(1.0), "kN s/m": Unit(1e3), "N s/mm": Unit(1e3)},
    "V": {"V": Unit(1.0), "mV": Unit(1e-3)},
    "Hz": {"Hz": Unit(1.0), "kHz": Unit(1e3), "1/s": Unit(1.0), "rpm": Unit(1.0 / MINUTE), "1/min": Unit(1.0 / MINUTE)},
    "rad": {"rad": Unit(1.0), "deg": Unit(math.pi / 180.0)},
    "degC": {"degC": Unit(1.0), "K": Unit(1.0, -273.15)},
    "byte": {"B": Unit(1.0), "kB": Unit(1e3), "MB": Unit(1e6), "GB": Unit(1e9)},
    "bit": {"bit": Unit(1.0)},
    "LSB": {"LSB": Unit(1.0)},
    "": {"": Unit(1.0), "%": Unit(1e-2)},
}
UNITS["1/s"] = UNITS["Hz"]
AMBIENT = 1e5  # [Pa], assumed: where gauge pressure is 0
ABSOLUTE = {f"{name} abs": Unit(UNITS["Pa"][name].factor, -AMBIENT) for name in ("Pa", "kPa", "MPa", "bar")}
_NUMBER = re.compile(
    r"\s*([-+]?(?:\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?|inf(?:inity)?))\s*(.*?)\s*", re.IGNORECASE
)
_LETTERED = re.compile(r"\s*[^\W\d]")  # "info" begins as infinity does
_INFINITE = re.compile(r"\s*inf(inity)?\s*", re.IGNORECASE)


SHOWN = {  # SI: what people read
    "Pa": "bar",
    "m": "mm",
    "m/s": "mm/s",
    "m^3/s": "l/min",
    "m^3": "cm^3",
    "s": "ms",
    "Pa s/m^3": "bar/(l/min)",
    "m^3/(s Pa)": "l/(min bar)",
    "rad": "deg",
}


def shown(unit: str, other: str = "") -> tuple[float, str]:
    """Factor from SI to the unit that people read, and that unit; `other`: another one than in SHOWN."""
    name = other or SHOWN.get(unit, unit)
    return 1.0 / UNITS[unit][name].factor if unit in UNITS else 1.0, name


SPELLED = str.maketrans(
    {"\u00b5": "u", "\u03bc": "u", "\u2212": "-", "\u00b2": "^2", "\u00b3": "^3", "\u00b7": " ", "\u22c5": " "}
)
DEGREE = re.compile("[\u00b0\u00ba] ?C|\u2103")
LITRE = re.compile(r"\bL\b")


def spelled(text: str) -> str:
    """A text with a unit as keyboards give it, in our spelling: micro, degrees, superscripts, a capital litre."""
    return LITRE.sub("l", DEGREE.sub("degC", text).translate(SPELLED))


def split(text: str) -> tuple[float, str]:
    """The number and the unit of a text such as "2.5 ms". Raises ValueError when there is no number."""
    if len(text) > LONGEST:
        raise ValueError(f"cannot read {text[:20]!r}..., {len(text)} characters: write a number with a unit")
    match = _NUMBER.fullmatch(spelled(text))
    if match is None:
        raise ValueError(f"cannot read {text!r}: write a number with a unit, such as '2.5 ms'")
    return float(match[1]), match[2]


def quantity(value: object, unit: str, gauge: bool = False) -> float:
    """A plain number (SI) or a text with a unit, in SI. Raises ValueError naming the nearest valid unit.

    gauge: it is a gauge pressure, which may be given as an absolute one, too.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"{value!r} is not a number{f' in {unit}' if unit else ''}")
    if not isinstance(value, str):
        return float(value)
    number, written = split(value)
    known = UNITS[unit] | (ABSOLUTE if gauge else {})
    if unit == "Pa" and written in ABSOLUTE and not gauge:
        raise ValueError(f"{value!r}: not a pressure above a vacuum or above ambient; write it without 'abs'")
    if written not in known:
        if not written and unit:
            return number
        raise ValueError(f"{value!r}: unit {written!r} does not fit here{nearest(written, known)}")
    return number * known[written].factor + known[written].offset


def si(text: str) -> float | str:
    """A text with any unit we know, in SI; one that does not begin with a number is a word. Raises ValueError."""
    if _LETTERED.match(text) and not _INFINITE.fullmatch(text):
        return text
    try:
        number, written = split(text)
    except ValueError:
        return text
    known = {name: unit for units in UNITS.values() for name, unit in units.items() if not unit.offset}
    known |= dict.fromkeys(("1/m", "s/m", "1/(m s)"), Unit(1.0))  # of gains
    if written not in known:
        raise ValueError(f"{text!r}: unit {written!r} is unknown{nearest(written, known)}")
    return number * known[written].factor


def in_si(unit: str) -> tuple[str, float]:
    """The SI unit of a unit, and the factor to it; a unit that we do not know, or that has an offset, stays."""
    if unit in UNITS:
        return unit, 1.0
    written = spelled(unit)
    for name, known in UNITS.items():
        if written in known and not known[written].offset:
            return name, known[written].factor
    return unit, 1.0


def interval(name: str, text: str, above: bool = True) -> tuple[float, float]:
    """The ends of LOW:HIGH, rising, from above 0 or from 0 on. Raises ValueError naming who asked."""
    low, _, high = text.partition(":")
    try:
        ends = float(low), float(high)
    except ValueError:
        ends = math.nan, math.nan
    if not all(map(math.isfinite, ends)):
        raise ValueError(f"{name} {text!r}: write LOW:HIGH, two numbers")
    if not 0.0 <= ends[0] < ends[1] or (above and ends[0] == 0.0):
        raise ValueError(f"{name} {text!r}: it must rise, and start {'above 0' if above else 'at 0 or more'}")
    return ends


def once(what: str, sign: str, text: str, error: ValueError) -> str:
    """What is said of a text that has been given to something: the text once, though the error may begin with it."""
    words = str(error)
    return f"{what}{sign if words.startswith(repr(text)) else ': '}{words}"


def option(name: str, text: str, unit: str, least: float = -math.inf, above: float = -math.inf) -> float:
    """The value of a command's option in SI. Raises UsageError naming the option and what it takes."""
    try:
        found = quantity(text, unit)
    except ValueError as error:
        raise UsageError(once(f"--{name}", " ", text, error)) from None
    if abs(found) < LARGEST and found >= least and found > above:
        return found
    limits = ((least, f"at least {least:g} {unit}"), (above, f"above {above:g} {unit}"), (0.0, "finite"))
    words = next(words for limit, words in limits if math.isfinite(limit))
    raise UsageError(f"--{name} {text!r}: must be {words}".rstrip())
