"""What a water hammer shows of friction: how its peaks decay and when they end, fig. 2.27.

A velocity end shut within a time short against the travel time T, a pressure end beyond: at the shut end the pressure
is below that of the other end up to 2 T, above up to 4 T, and so on.
"""

from typing import NamedTuple

import numpy as np

from twin.lines.lab.pipe import Array, Case, History


class Peaks(NamedTuple):
    """The first peaks above the held pressure at end 1."""

    amplitude: Array  # [Pa] over the held pressure
    end: Array  # [s], when the pressure falls through the held pressure; NaN where it does not


def peaks_of(case: Case, history: History, count: int = 10) -> Peaks:
    """The peaks of a case whose end 2 holds constant pressure."""
    travel, level = case.pipe.travel_time, case.right.course(0.0)
    amplitude, end = np.full(count, np.nan), np.full(count, np.nan)
    for n in range(1, count + 1):
        t, p = history.time / travel, history.p_1 - level
        amplitude[n - 1] = p[(t > 4 * n - 1.0) & (t < 4 * n + 0.4)].max()
        near = np.flatnonzero((t > 4 * n - 0.8) & (t < 4 * n + 1.2))
        falls = near[:-1][(p[near[:-1]] > 0.0) & (p[near[1:]] <= 0.0)]
        if len(falls):
            i = falls[0]
            share = p[i] / (p[i] - p[i + 1])
            end[n - 1] = history.time[i] + share * (history.time[i + 1] - history.time[i])
    return Peaks(amplitude, end)
