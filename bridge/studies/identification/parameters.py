"""The numbers that a fit may change, "rig.load.mass", "rig.load.mass=100:400 kg"; limits, and what is known before.

A positive number is fitted by its logarithm, any other in shares of itself or of its range. What is known before is a
normal distribution about the scenario's own value: of a logarithm a factor of ten to either side, unless it is stated.
"""

import difflib
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import LIKENESS, LONGEST_WORD, SLIP, UsageError, nearest
from bridge.scenario.places import in_unit
from bridge.scenario.units import UNITS, quantity, shown, split
from twin.quantity import Number
from twin.rig import RIG

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

Array = NDArray[np.float64]
Values = dict[str, dict[str, Any]]
WIDE = math.log(10.0)  # deviation of what is known before, of a logarithm or in shares
SHARE = 0.1  # of a range, where the value itself is zero
PLAIN = 1e-2  # scale of a number that is zero and has no range
DIGITS = 8
LISTED = "`hydrotwin describe SCENARIO` lists the numbers of a rig"


class Parameter(NamedTuple):
    """One number to fit."""

    name: str  # rig.load.mass
    unit: str  # SI
    start: float
    low: float
    high: float
    scale: float  # 0.0: by its logarithm
    prior: float  # deviation about the start, of the logarithm or in scales

    def value(self, u: float) -> float:
        """The number at a place u of the fit; 0 is its start."""
        return self.start * math.exp(u) if self.scale == 0.0 else self.start + self.scale * u

    def place(self, value: float) -> float:
        """The place of a number."""
        return math.log(value / self.start) if self.scale == 0.0 else (value - self.start) / self.scale

    @property
    def bounds(self) -> tuple[float, float]:
        """Of the place."""
        low = -math.inf if self.scale == 0.0 and self.low <= 0.0 else self.place(self.low)
        return low, self.place(self.high) if math.isfinite(self.high) else math.inf

    def deviation(self, value: float, spread: float) -> float:
        """Deviation of the number [SI] for one of its place."""
        return value * spread if self.scale == 0.0 else self.scale * spread

    def text(self, value: float) -> str:
        """The number as a scenario takes it."""
        return f"{value:.{DIGITS}g}"

    def words(self, value: float) -> str:
        """The number for people."""
        factor, unit = shown(self.unit)
        return f"{value * factor:.4g} {unit}".rstrip()


def parameters_of(texts: Sequence[str], scenario: "Scenario", priors: Mapping[str, float] = {}) -> list[Parameter]:
    """What texts name, apart by commas. Raises UsageError with one line."""
    found = [_parameter(text.strip(), scenario, priors) for entry in texts for text in entry.split(",") if text.strip()]
    names = [one.name for one in found]
    if not found:
        raise UsageError("name what is to be fitted, such as --fit rig.load.mass,rig.cylinder.leakage_resistance")
    if twice := [name for name in names if names.count(name) > 1]:
        raise UsageError(f"--fit {twice[0]} is named twice")
    if strange := [name for name in priors if name not in names]:
        raise UsageError(f"--prior {strange[0]} is not fitted{nearest(strange[0], names)}")
    return found


def _parameter(text: str, scenario: "Scenario", priors: Mapping[str, float]) -> Parameter:
    name, _, limits = (part.strip() for part in text.partition("="))
    entry = _entry(name)
    _, part, key = name.split(".")
    start = float(scenario.rig_values()[part][key])
    low, high = _limits(name, limits, entry)
    if not math.isfinite(start):
        raise UsageError(f"--fit {name}: the scenario has {start:g}; give a start with --set {name}=VALUE")
    if not low <= start <= high:
        raise UsageError(f"--fit {text}: the scenario's own value {start:g} lies outside; set another with --set")
    scale = 0.0 if start > 0.0 and low >= 0.0 else _scale(start, low, high)
    return Parameter(name, entry.unit, start, low, high, scale, priors.get(name, WIDE))


def _entry(name: str) -> Number:
    places = {f"rig.{part}.{key}": entry for part, entries in RIG.items() for key, entry in entries.items()}
    entry = places.get(name)
    if entry is None:
        numbers = [place for place, one in places.items() if isinstance(one, Number)]
        raise UsageError(f"--fit {name!r} is not a number of the rig{_meant(name, numbers)} {LISTED}")
    if not isinstance(entry, Number):
        raise UsageError(f"--fit {name} is not a number: it is {entry.value!r}; {LISTED}")
    return entry


def _meant(name: str, numbers: Sequence[str]) -> str:
    """One number that is almost of this name, else a few like it; all are too many to print."""
    word = name[:LONGEST_WORD]
    slip = difflib.get_close_matches(word, numbers, n=1, cutoff=SLIP)
    near = slip or difflib.get_close_matches(word, numbers, n=3, cutoff=LIKENESS)
    return f"; did you mean {' or '.join(near)}?" if near else ":"


def _limits(name: str, text: str, entry: Number) -> tuple[float, float]:
    if not text:
        return entry.low, entry.high
    low, sign, high = (part.strip() for part in text.partition(":"))
    if not sign:
        raise UsageError(f"--fit {name}={text}: write the limits as LOW:HIGH")
    try:
        unit = split(high)[1]
        known = unit if unit in UNITS.get(entry.unit, {}) else ""
        ends = [quantity(end if split(end)[1] else f"{end} {known}", entry.unit) for end in (low, high)]
    except ValueError as error:
        raise UsageError(f"--fit {name}={text}: {error}") from None
    beyond = (-math.inf < ends[0] < entry.low, "low", entry.low), (entry.high < ends[1] < math.inf, "high", entry.high)
    for is_beyond, way, end in beyond:
        if is_beyond:
            what = "least" if way == "low" else "greatest"
            raise UsageError(
                f"--fit {name}={text}: is too {way}: the {what} that a scenario takes is {end:g} {entry.unit}"
            )
    found = max(entry.low, ends[0]), min(entry.high, ends[1])
    if not found[0] < found[1]:
        raise UsageError(f"--fit {name}={text}: must rise, within {entry.low:g} and {entry.high:g} {entry.unit}")
    return found


def _scale(start: float, low: float, high: float) -> float:
    if start != 0.0:
        return abs(start)
    return SHARE * (high - low) if math.isfinite(high - low) else PLAIN


def priors_of(texts: Sequence[str]) -> dict[str, float]:
    """Deviations that texts NAME=SHARE state, such as "rig.load.mass=5 %". Raises UsageError."""
    found = {}
    for text in texts:
        name, sign, share = (part.strip() for part in text.partition("="))
        try:
            found[name] = in_unit(share, "", "") if not share.endswith("%") else 0.01 * float(share[:-1])
        except ValueError:
            found[name] = math.nan
        if not sign or not found[name] > 0.0:
            raise UsageError(f"--prior {text!r}: write NAME=SHARE, such as 'rig.load.mass=5 %'")
    return found


def with_places(values: Mapping[str, Mapping[str, Any]], parameters: Sequence[Parameter], u: Array) -> Values:
    """The rig's values with those of the parameters at some places."""
    found = {part: dict(entries) for part, entries in values.items()}
    for parameter, place in zip(parameters, u, strict=True):
        _, part, key = parameter.name.split(".")
        found[part][key] = min(max(parameter.value(float(place)), parameter.low), parameter.high)
    return found
