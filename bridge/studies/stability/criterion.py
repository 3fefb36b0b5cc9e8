"""When a run counts as oscillating: the one criterion of all that is measured on the twin.

The piston is held, at rest; the reference steps by a small size and stays. What follows is cut into thirds. The loop
oscillates if in the last third the position goes up and down, peak to peak, by at least FLOOR of the step, by no less
than what the card can tell, and by no less than KEPT of what it did in the middle third, or by GROWN steps, however
irregularly. So a slow decay is told from a swing that stays, and from one that grows: near an edge the answer is that
of the sign of the growth, within ln(KEPT) over a third of the run.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controller.metrics import LIMIT_CYCLE_THRESHOLD

FLOOR = 0.1  # of the step
KEPT = 0.95  # of the middle third's swing
GROWN = 2.0  # steps; what dies away has gone by less
INTERVALS = 90  # sampling intervals of a run after its step, at least
SECONDS = 5.0  # and seconds, for the circuit's own swings

Array = NDArray[np.float64]


class Swing(NamedTuple):
    """What a run did after its step."""

    oscillates: bool
    amplitude: float  # [m], half of peak to peak, last third
    growth: float  # swing of the last third over that of the middle one
    frequency: float  # [Hz], of the last third; 0.0 without four crossings of its middle


def judge_swing(time: Array, position: Array, at: float, size: float, exact: bool) -> Swing:
    """Judge a run whose reference stepped by `size` [m] at `at` [s]; exact: the card rounds nothing."""
    after = time > at
    _, middle, last = np.array_split(position[after], 3)
    before, swing = float(np.ptp(middle)), float(np.ptp(last))
    least = max(FLOOR * abs(size), 0.0 if exact else LIMIT_CYCLE_THRESHOLD)
    growth = swing / before if before > 0.0 else math.inf
    frequency = crossing_frequency(time[-len(last) :], last)
    kept = growth >= KEPT or swing >= GROWN * abs(size)
    return Swing(swing >= least and kept, 0.5 * swing, growth, frequency)


def crossing_frequency(time: Array, values: Array) -> float:
    """Mean frequency [Hz] of a swing's upward passages of its middle; a quarter of its size tells them from noise."""
    e = values - 0.5 * (values.max() + values.min())
    far = np.flatnonzero(np.abs(e) > 0.25 * np.abs(e).max())
    side = np.sign(e[far])
    turned = np.flatnonzero(np.diff(side) > 0.0)
    if len(turned) < 2:
        return 0.0
    k, n = far[turned], far[turned + 1]  # last below, first above: between them it passes the middle
    at = time[k] - e[k] * (time[n] - time[k]) / (e[n] - e[k])
    return float((len(at) - 1) / (at[-1] - at[0]))


def duration(at: float, interval: float) -> float:
    """Length [s] of a run that can be judged, a whole number of sampling intervals after the step."""
    return at + interval * math.ceil(max(INTERVALS, SECONDS / interval))
