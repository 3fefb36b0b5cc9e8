"""What is known of the sensors of a log: noise before the converter, and its quantum; stated, else estimated; range."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError
from bridge.recording.logs.map import Signal, si_of
from bridge.scenario.units import split

ROOT_12 = math.sqrt(12.0)  # of an even distribution over a quantum
SECOND = math.sqrt(6.0)  # rms of x[k-1] - 2 x[k] + x[k+1] of white noise of rms 1
FEWEST_LEVELS = 8  # among the values: of fewer their steps say little of a converter
MOST_LEVELS = 0.6  # of the number of values: of more there is hardly a value twice, and no converter
MEDIAN = 0.6745  # of the absolute values of a normal distribution of rms 1


class Sensor(NamedTuple):
    """Noise of a signal, and its range, SI."""

    noise: float  # rms before the converter
    quantum: float  # of the converter; 0: none
    stated: bool  # False: the noise is estimated from the data
    low: float = -math.inf  # ends of the range: a reading there says only that the signal was no nearer
    high: float = math.inf

    @property
    def rms(self) -> float:
        """With what rounding adds."""
        return math.hypot(self.noise, self.quantum / ROOT_12)


def sensor_of(entry: Signal, unit: str, values: NDArray[np.float64], who: str) -> Sensor:
    """As a map states it; the noise estimated from the values where the map says nothing of it. Raises UsageError."""
    low, high = _ends(entry, unit, who)
    quantum = (high - low) / 2.0**entry.bits if entry.bits and math.isfinite(high - low) else 0.0
    if entry.noise is not None:
        return Sensor(_noise(entry.noise, quantum, unit, who), quantum, True, low, high)
    found = Sensor(0.0, quantum, True) if quantum else estimated(values)
    return found._replace(low=low, high=high)


def _ends(entry: Signal, unit: str, who: str) -> tuple[float, float]:
    if entry.range is None:
        return -math.inf, math.inf
    low, high = (si_of(end, unit, f"{who}: range") for end in entry.range)
    if not high > low:
        raise UsageError(f"{who}: range {entry.range}: the second end must be above the first")
    return low, high


def _noise(noise: float | str, quantum: float, unit: str, who: str) -> float:
    if isinstance(noise, str) and noise.strip().endswith("LSB"):
        number, _ = split(noise)
        if not quantum:
            raise UsageError(f"{who}: noise {noise!r} needs `range` and `bits`, which make one LSB")
        return number * quantum
    found = si_of(noise, unit, f"{who}: noise") if not isinstance(noise, str) else _difference(noise, unit, who)
    if not 0.0 <= found < math.inf:
        raise UsageError(f"{who}: noise {noise!r}: must be 0 or more")
    return found


def _difference(noise: str, unit: str, who: str) -> float:
    """A noise is a difference: no unit's zero point counts."""
    return si_of(noise, unit, f"{who}: noise") - si_of(f"0 {split(noise)[1]}".strip(), unit, f"{who}: noise")


def estimated(values: NDArray[np.float64]) -> Sensor:
    """Noise by second differences, whose median motion does not shift, and the quantum by the steps between values."""
    known = values[np.isfinite(values)]
    step = quantum(known)
    with np.errstate(invalid="ignore"):
        second = np.abs(values[:-2] - 2.0 * values[1:-1] + values[2:])
    second = second[np.isfinite(second)]
    total = float(np.median(second)) / MEDIAN / SECOND if len(second) else 0.0
    return Sensor(math.sqrt(max(0.0, total**2 - step**2 / 12.0)), step, False)


def quantum(values: NDArray[np.float64]) -> float:
    """The step between neighbours among the values that occur, to a fraction of what they are printed to.

    Of steps that were rounded when they were printed the mean is right, where it is counted over many.
    """
    known = values[np.isfinite(values)]
    levels = np.unique(known)
    if len(levels) < FEWEST_LEVELS or len(levels) > MOST_LEVELS * len(known):
        return 0.0
    steps = np.diff(levels)
    least = float(np.percentile(steps, 5.0))
    if not least > 0.0:
        return 0.0
    single = steps[steps <= 1.5 * least]
    rough = float(single.mean())
    counts = np.concatenate([[0.0], np.cumsum(np.round(steps / rough))])
    return float(np.polyfit(counts, levels, 1)[0]) if len(single) > 0.3 * len(steps) else 0.0


def plain(sensor: Sensor) -> dict[str, Any]:
    """For metadata; an end of the range that is not known is left out."""
    ends = {name: end for name, end in (("low", sensor.low), ("high", sensor.high)) if math.isfinite(end)}
    return {"noise": sensor.noise, "quantum": sensor.quantum, "stated": sensor.stated, **ends}


def from_plain(told: Mapping[str, Any]) -> Sensor:
    """The sensor in metadata."""
    noise, quantum = float(told.get("noise") or 0.0), float(told.get("quantum") or 0.0)
    ends = float(told.get("low", -math.inf)), float(told.get("high", math.inf))
    return Sensor(noise, quantum, bool(told.get("stated")), *ends)
