"""Bands that a signal keeps to at every moment: "p1 <= 120 bar", "error <= 5 mm"."""

import re
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError, nearest
from bridge.scenario.bands import METRICS, limit_of
from bridge.scenario.units import shown
from controller.bands import RELATIONS
from twin.topology import CHANNELS, OBSERVED

ERROR = "error"  # the position error, whichever way
READS = {name: channel.reads for name, channel in CHANNELS.items()}  # the card's names mean what the card touches
EXTREMES = {"<=": ("peak", "greatest", "max"), ">=": ("least", "min")}  # words that a scenario's bands have
_AT = {name: at for at, name in enumerate(OBSERVED)}
_BAND = re.compile(r"\s*(?:(peak|greatest|max|least|min)[\s_]+)?([^<>=]+?)\s*(<=|>=)\s*(.+?)\s*")


class MomentBand(NamedTuple):
    """One such band."""

    text: str
    signal: str  # of OBSERVED, or ERROR
    relation: str  # of RELATIONS
    limit: float  # SI

    def broken(self, rows: NDArray[np.float64], error: float) -> bool:
        """Is it broken? rows: the observed quantities at each tick; error [m]."""
        values = np.array([abs(error)]) if self.signal == ERROR else rows[:, _AT[self.signal]]
        return not bool(RELATIONS[self.relation](values, self.limit).all())


def bands_of(option: str, texts: Iterable[str]) -> list[MomentBand]:
    """The bands of an option, such as "p1 <= 120 bar". Raises UsageError naming the nearest valid signal or unit."""
    listed = [texts] if isinstance(texts, str) else texts
    return [_band(option, text) for text in listed]


def _band(option: str, text: str) -> MomentBand:
    match = _BAND.fullmatch(text)
    if match is None:
        raise UsageError(f"{option} {text!r}: write 'signal <= value unit', such as 'p1 <= 120 bar'")
    extreme, words, relation, limit = match.groups()
    if extreme and extreme not in EXTREMES[relation]:
        raise UsageError(f"{option} {text!r}: leave {extreme!r} out, each moment is looked at")
    signal = READS.get(words, words)
    unit = "m" if signal == ERROR else OBSERVED.get(signal)
    if unit is None:
        raise UsageError(f"{option} {text!r}: {_unknown(words)}")
    try:
        return MomentBand(text, signal, relation, limit_of(limit, unit, shown(unit)[1]))
    except ValueError as error:
        raise UsageError(f"{option} {text!r}: {error}") from None


def _unknown(words: str) -> str:
    if re.sub(r"[\s-]+", "_", words) in METRICS:
        return f"{words!r} is known when a run is over, and a band here is about each moment: 'error <= 5 mm'"
    return f"no signal {words!r}{nearest(words, [ERROR, *dict.fromkeys((*CHANNELS, *OBSERVED))])}"
