"""How far what was read lay from what a follower expected: of every channel, those that it does not use, too."""

import math
from typing import NamedTuple

import numpy as np

from bridge.recording.reader import Recording
from bridge.wire.estimates import DEVIATION
from bridge.wire.messages import ESTIMATE, INNOVATION
from twin.estimation.quantities import Standing
from twin.topology import CHANNELS


class Missed(NamedTuple):
    """Of one channel, at the corrections of an estimate that follows."""

    rms: float  # reading less prediction, SI; NaN: never read
    deviations: float  # rms of the same in deviations that it should have
    scans: int


def missed(recording: Recording) -> dict[str, Missed]:
    """By channel. Empty where nobody has followed."""
    if not (recording.counts.get(INNOVATION) and recording.counts.get(ESTIMATE)):
        return {}
    found, estimates = recording.columns(INNOVATION), recording.columns(ESTIMATE)
    following = np.isin(found["stamp"], estimates["stamp"][estimates["standing"] == Standing.FOLLOWING])
    return {name: _missed(found[name][following], found[name + DEVIATION][following]) for name in CHANNELS}


def _missed(away: np.ndarray, deviation: np.ndarray) -> Missed:
    known = np.isfinite(away) & (deviation > 0.0)
    if not known.any():
        return Missed(math.nan, math.nan, 0)
    away, deviation = away[known], deviation[known]
    return Missed(_rms(away), _rms(away / deviation), int(known.sum()))


def _rms(values: np.ndarray) -> float:
    return math.sqrt(float((values * values).mean()))
