"""Statistics of a signal within a part of a run, judged by the band they must keep.

A window is bounded by moments of the run and offsets from them, so that one band holds for runs that are slower.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from controller.bands import RELATIONS, STATISTICS, Band, WindowBand

Array = npt.NDArray[np.floating]


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


COMPUTED: dict[str, Callable[[Array], Any]] = dict(zip(STATISTICS, (np.mean, np.min, np.max, _rms), strict=True))


class WindowResult(NamedTuple):
    """The statistic found, NaN for a window without a sample, and whether it keeps the band."""

    value: float
    passed: bool


def judge_window(band: WindowBand, time: Array, signal: Array, moments: Mapping[str, float]) -> WindowResult:
    """The result for one band. time: [s]; moments: [s], NaN for one that never came, which no band passes."""
    inside = signal[within(time, bounds(band, moments))]
    value = float(COMPUTED[band.statistic](inside)) if inside.size else float("nan")
    return WindowResult(value, bool(RELATIONS[band.relation](value, band.limit)))


def bounds(band: Band | WindowBand, moments: Mapping[str, float]) -> tuple[float, float]:
    """Begin and end of a band's window [s]; NaN for a moment that never came."""
    begin, end = (moments[moment.name] + moment.offset for moment in (band.begin, band.end))
    return begin, end


def within(time: Array, window: tuple[float, float]) -> npt.NDArray[np.bool_]:
    """The samples of a window."""
    return (time >= window[0] - 1e-9) & (time <= window[1] + 1e-9)
