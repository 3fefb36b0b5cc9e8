"""What can be asked of a run: a metric of it or of a part of it, or a statistic of a signal, as bands name them."""

from typing import TYPE_CHECKING, NamedTuple

from bridge.errors import UsageError
from bridge.scenario.bands import UNDEFINED, outside, parse_measure, units_of
from bridge.scenario.units import shown
from controller.bands import WHOLE, Band, WindowBand

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario


class Measure(NamedTuple):
    """One number of a run."""

    words: str
    band: Band | WindowBand  # that names it
    unit: str  # SI
    shown_unit: str

    @property
    def label(self) -> str:
        """Words and the unit that people read."""
        return f"{self.words} [{self.shown_unit}]" if self.shown_unit else self.words

    @property
    def factor(self) -> float:
        """From SI to the unit that people read."""
        return shown(self.unit, self.shown_unit)[0] if self.shown_unit != "travels" else 1.0

    @property
    def of_run(self) -> bool:
        """Is it among the metrics of the whole run?"""
        return isinstance(self.band, Band) and (self.band.begin, self.band.end) == WHOLE

    @property
    def why_undefined(self) -> str:
        """Why a good run can be without it."""
        never = "no sample lies in its window, or its moment never came"
        return UNDEFINED.get(self.band.metric, never) if isinstance(self.band, Band) else never


def measures_of(texts: list[str]) -> list[Measure]:
    """What texts such as "rms error, overshoot" ask for. Raises UsageError naming the nearest."""
    words = [word.strip() for text in texts for word in text.split(",") if word.strip()]
    if not words:
        raise UsageError("name a metric, such as --metrics 'rms error, overshoot'")
    if twice := [word for word in words if words.count(word) > 1]:
        raise UsageError(f"metric {twice[0]!r} is named twice")
    return [measure(word) for word in words]


def measure(words: str) -> Measure:
    """One of them. Raises UsageError naming the nearest."""
    try:
        band = parse_measure(words)
    except ValueError as error:
        raise UsageError(f"metric {words!r}: {error}") from None
    return Measure(words, band, *units_of(band))


def refuse_outside(measures: list[Measure], scenario: "Scenario") -> None:
    """Raises UsageError for a window that the run does not reach."""
    for asked in measures:
        if wrong := outside(asked.band, scenario.duration):
            raise UsageError(f"metric {asked.words!r}: {wrong}; lengthen duration or move the window")
