"""Is what a fit leaves noise? For each signal the rms residual, and a test of its correlation with its own past.

G. Ljung and G. Box, Biometrika 65 (1978) 297: Q = n (n + 2) sum r_k^2/(n - k) over lags up to LAGS is chi squared
where the residual e is white: n (n + 2)/(n - k) is one over the variance of r_k = sum e_t e_(t-k)/sum e_t^2. Where
samples are not compared, n counts those that are, and the number n_k of pairs of them that are k apart stands in place
of n - k. With tens of thousands of samples Q sees correlations that change nothing, such as those of rounding; so a
residual passes, too, whose greatest correlation is below SMALL, of each pair: r_k (n - k)/n_k.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from bridge.studies.identification.data import Array
from bridge.studies.identification.fit import Fitted

Mask = NDArray[np.bool_]
LAGS = 20
DOUBT = 1e-3  # probability below which a residual is not white
SMALL = 0.05  # correlation that is too small to matter
LOUD = 1.1  # rms residual, in deviations, above which it is more than the noise


class Whiteness(NamedTuple):
    """Of one signal of one record."""

    record: str
    signal: str
    unit: str
    rms: float  # [SI]
    deviations: float  # the same in deviations of the noise
    motion: float  # rms of the signal about its mean [SI]
    statistic: float  # Q
    probability: float
    correlation: float  # greatest, of lags 1 .. LAGS
    compared: int  # samples

    @property
    def passed(self) -> bool:
        """Is it noise?"""
        return self.deviations <= LOUD and (self.probability >= DOUBT or self.correlation <= SMALL)

    @property
    def verdict(self) -> str:
        """The same in words."""
        return "not compared" if not self.compared else "noise" if self.passed else "not noise"

    @property
    def share(self) -> float:
        """The rms residual over the rms motion."""
        return self.rms / self.motion if self.motion > 0.0 else math.inf


def whiteness(found: Fitted) -> list[Whiteness]:
    """Of every signal of every record."""
    tested = []
    for number, record in enumerate(found.task.records):
        pairs = [(shot, at) for shot, at in zip(found.task.shots, found.shots, strict=True) if shot.record == number]
        for j, signal in enumerate(record.signals):
            parts = [at.residual.reshape(len(record.signals), -1)[j] for _, at in pairs]
            spans = [slice(shot.begin + 1, shot.end + 1) for shot, _ in pairs]
            masks = [signal.counted[span] for span in spans]
            counted = np.concatenate(masks)
            value = np.concatenate([signal.value[span] for span in spans])[counted]
            deviations = _rms(np.concatenate(parts), int(counted.sum()))
            motion = float(np.std(value)) if len(value) else 0.0
            tested.append(
                Whiteness(
                    record.name, signal.name, signal.unit, deviations * signal.deviation, deviations, motion,
                    *ljung_box(parts, masks), int(counted.sum()),
                )
            )  # fmt: skip
    return tested


def _rms(values: Array, count: int) -> float:
    return math.sqrt(float(values @ values) / max(1, count))


def ljung_box(parts: Sequence[Array], masks: Sequence[Mask], lags: int = LAGS) -> tuple[float, float, float]:
    """Q, its probability and the greatest correlation, over stretches that do not hang together.

    parts: zero where their masks say that nothing is compared.
    """
    power = sum(float(part @ part) for part in parts)
    count = sum(int(mask.sum()) for mask in masks)
    if power == 0.0 or count <= lags:
        return 0.0, 1.0, 0.0
    lag = np.arange(1, lags + 1)
    r = np.array([sum(float(part[k:] @ part[:-k]) for part in parts) for k in lag]) / power
    pairs = np.array([sum(int((mask[k:] & mask[:-k]).sum()) for mask in masks) for k in lag])
    r, lag, pairs = r[pairs > 0], lag[pairs > 0], pairs[pairs > 0]
    statistic = count * (count + 2.0) * float((r**2 / pairs).sum())
    greatest = float(np.abs(r * ((count - lag) / pairs)).max(initial=0.0))
    return statistic, float(chi2.sf(statistic, len(lag))) if len(lag) else 1.0, greatest
