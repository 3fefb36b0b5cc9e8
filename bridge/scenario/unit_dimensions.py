"""Units as FMI wants them: exponents of the SI's base units."""

import re
from collections import Counter
from functools import cache

SYMBOLS: dict[str, dict[str, int]] = {
    "m": {"m": 1},
    "s": {"s": 1},
    "kg": {"kg": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "Hz": {"s": -1},
    "rad": {"rad": 1},
    "degC": {"K": 1},
    "1": {},
}
OFFSETS = {"degC": 273.15}  # SI = factor * value + offset
_TOKEN = re.compile(r"([A-Za-z]+|1)(?:\^(\d+))?")


@cache
def dimensions(unit: str) -> dict[str, int]:
    """The base units of a unit such as "m^3/(s Pa)" and their exponents; those that are 0 are left out."""
    above, _, below = unit.partition("/")
    found: Counter[str] = Counter()
    for text, way in ((above, 1), (below, -1)):
        for name, power in _TOKEN.findall(text):
            for base, exponent in SYMBOLS[name].items():
                found[base] += way * exponent * int(power or 1)
    return {base: exponent for base, exponent in found.items() if exponent}
