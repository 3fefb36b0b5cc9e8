"""The numbers that a search may choose: "controller.gain=0.1:4", "loop.delay=0:20 ms", "controller.gain=0.1:10:log".

A search sees shares from 0 to 1 of each range.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

from bridge.errors import UsageError
from bridge.runs.sweep.axes import with_shared_unit
from bridge.scenario.places import in_unit, refuse_unitless, si_unit_at, usual_unit_at, value_at
from bridge.scenario.units import quantity, split

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

DIGITS = 6  # of a value that is tried
ON_GRID = {"loop.delay": "step", "loop.sample_period": "daq_period", "loop.offset": "daq_period"}  # whole ones of these


class Varied(NamedTuple):
    """One number and its range."""

    name: str
    low: float  # in the unit
    high: float
    unit: str
    si_unit: str  # of the quantity; "" for gains and plain numbers
    even_ratios: bool
    grid: float  # its steps, in the unit; 0.0: none
    own: float | None  # the scenario's, in the unit

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    @property
    def own_share(self) -> float:
        """Where the scenario's own value stands in the range, the middle where it is not in it."""
        return 0.5 if self.own is None or not self.low <= self.own <= self.high else self.share(self.own)

    def value(self, share: float, digits: int = DIGITS) -> float:
        """The value at a share of the range, as it is tried."""
        if self.even_ratios:
            value = self.low * (self.high / self.low) ** share
        else:
            value = self.low + (self.high - self.low) * share
        if self.grid:
            value = round(value / self.grid) * self.grid
        value = float(f"{value:.{DIGITS if self.grid else digits}g}")
        return min(max(value, self.low), self.high)

    def share(self, value: float) -> float:
        """The share of the range at which a value stands."""
        if self.even_ratios:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def text(self, value: float) -> str:
        """The value as a scenario takes it."""
        return f"{value:.{DIGITS}g} {self.unit}".rstrip()


def varied_of(texts: list[str], scenario: "Scenario") -> list[Varied]:
    """What texts NAME=LOW:HIGH ask for. Raises UsageError with one line."""
    found = [_varied(text, scenario) for text in texts]
    names = [one.name for one in found]
    if not found:
        raise UsageError("name what may be varied, such as --vary controller.gain=0.1:4")
    if twice := [name for name in names if names.count(name) > 1]:
        raise UsageError(f"--vary {twice[0]} is named twice")
    return found


def _varied(text: str, scenario: "Scenario") -> Varied:
    name, _, values = text.partition("=")
    name, parts = name.strip(), [part.strip() for part in values.split(":")]
    log = parts[2:] == ["log"]
    if not name or len(parts) < 2 or (len(parts) > 2 and not log):
        raise UsageError(f"--vary {text!r}: write NAME=LOW:HIGH, such as controller.gain=0.1:4, or NAME=LOW:HIGH:log")
    try:
        ends = with_shared_unit(parts[:2])
        refuse_unitless(scenario, name, ends)
        unit, si_unit = split(ends[1])[1] or usual_unit_at(scenario, name), si_unit_at(scenario, name)
        low, high = (in_unit(end, si_unit, unit) for end in ends)
    except ValueError as error:
        raise UsageError(f"--vary {name}: {error}") from None
    if not low < high or not math.isfinite(high - low) or (log and low <= 0.0):
        raise UsageError(f"--vary {text!r}: the range must rise{', from above 0' if log else ''}")
    return Varied(name, low, high, unit, si_unit, log, *_around(scenario, name, si_unit, unit))


def _around(scenario: "Scenario", name: str, si_unit: str, unit: str) -> tuple[float, float | None]:
    """The grid of a value and the scenario's own."""
    step = getattr(scenario.loop, ON_GRID[name]) if name in ON_GRID else 0.0
    one = quantity(f"1 {unit}", si_unit) - quantity(f"0 {unit}", si_unit) if si_unit else 1.0
    own = value_at(scenario, name)
    if isinstance(own, bool) or not isinstance(own, int | float | str):
        return step / one, None
    try:
        text = own if isinstance(own, str) else f"{own!r} {si_unit}"
        return step / one, in_unit(text, si_unit, unit)
    except ValueError:
        return step / one, None
