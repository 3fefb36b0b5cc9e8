"""Numbers with units: what a person may write where SI is kept."""

import difflib
import math
import re
from typing import NamedTuple


class Unit(NamedTuple):
    """value_SI = factor * value + offset."""

    factor: float
    offset: float = 0.0


MINUTE = 60.0
UNITS: dict[str, dict[str, Unit]] = {
    "s": {"s": Unit(1.0), "ms": Unit(1e-3), "us": Unit(1e-6), "ns": Unit(1e-9), "min": Unit(MINUTE), "h": Unit(3600.0)},
    "m": {"m": Unit(1.0), "cm": Unit(1e-2), "mm": Unit(1e-3), "um": Unit(1e-6)},
    "m/s": {"m/s": Unit(1.0), "mm/s": Unit(1e-3)},
    "m^2/s": {"m^2/s": Unit(1.0), "mm^2/s": Unit(1e-6), "cSt": Unit(1e-6)},
    "m^3": {"m^3": Unit(1.0), "l": Unit(1e-3), "cm^3": Unit(1e-6)},
    "m^3/s": {"m^3/s": Unit(1.0), "l/min": Unit(1e-3 / MINUTE), "l/s": Unit(1e-3)},
    "Pa": {"Pa": Unit(1.0), "kPa": Unit(1e3), "MPa": Unit(1e6), "GPa": Unit(1e9), "bar": Unit(1e5)},
    "Pa s/m^3": {"Pa s/m^3": Unit(1.0), "bar s/m^3": Unit(1e5), "bar/(l/min)": Unit(1e5 * MINUTE / 1e-3)},
    "kg": {"kg": Unit(1.0), "g": Unit(1e-3), "t": Unit(1e3)},
    "kg/m^3": {"kg/m^3": Unit(1.0), "g/cm^3": Unit(1e3)},
    "m/s^2": {"m/s^2": Unit(1.0)},
    "N": {"N": Unit(1.0), "kN": Unit(1e3)},
    "N/m": {"N/m": Unit(1.0), "kN/m": Unit(1e3), "N/mm": Unit(1e3)},
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
_NUMBER = re.compile(
    r"\s*([-+]?(?:\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+(?:[eE][-+]?\d+)?|inf(?:inity)?))\s*(.*?)\s*", re.IGNORECASE
)


def split(text: str) -> tuple[float, str]:
    """The number and the unit of a text such as "2.5 ms". Raises ValueError when there is no number."""
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise ValueError(f"{text!r} is no number with a unit, such as '2.5 ms'")
    return float(match[1]), match[2]


def quantity(value: object, unit: str) -> float:
    """A plain number (SI) or a text with a unit, in SI. Raises ValueError naming the nearest valid unit."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"{value!r} is no number{f' in {unit}' if unit else ''}")
    if not isinstance(value, str):
        return float(value)
    number, written = split(value)
    known = UNITS[unit]
    if written not in known:
        if not written and unit:
            return number
        near = difflib.get_close_matches(written, known, n=1, cutoff=0.0)
        valid = ", ".join(name or "none" for name in known)
        raise ValueError(f"{value!r}: unit {written!r} does not fit here; nearest: {near[0]!r} (valid: {valid})")
    return number * known[written].factor + known[written].offset
