"""Statistics of a signal within a part of a run, judged by the band they must keep.

A window is bounded by moments of the run and offsets from them, so that one band holds for runs that are slower.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from controller.bands import RELATIONS, STATISTICS, WindowBand

Array = npt.NDArray[np.floating]
COMPUTED: dict[str, Callable[[Array], Any]] = dict(zip(STATISTICS, (np.mean, np.min, np.max), strict=True))


class WindowResult(NamedTuple):
    """The statistic found, NaN for a window without a sample, and whether it keeps the band."""

    value: float
    passed: bool


def judge_window(band: WindowBand, time: Array, signal: Array, moments: Mapping[str, float]) -> WindowResult:
    """The result for one band. time: [s]; moments: [s], NaN for one that never came, which no band passes."""
    begin, end = (moments[moment.name] + moment.offset for moment in (band.begin, band.end))
    inside = signal[(time >= begin - 1e-9) & (time <= end + 1e-9)]
    value = float(COMPUTED[band.statistic](inside)) if inside.size else float("nan")
    return WindowResult(value, bool(RELATIONS[band.relation](value, band.limit)))
