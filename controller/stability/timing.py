"""When a controller samples, when its commands act, and where its velocity comes from: one argument of every loop here.

The derivatives are those of `controller.law`: "measured" is the tachometer at the sample, "backward" the difference of
the last two samples, "filtered" that difference behind a filter of first order.
"""

import math
from typing import NamedTuple

from numpy.typing import ArrayLike

MEMORY = {"measured": 0, "backward": 1, "filtered": 2}  # numbers that a derivative keeps from one sample to the next
DERIVATIVES = tuple(MEMORY)


class Timing(NamedTuple):
    """Times of a sampled controller; arrays of periods and delays broadcast with the loop's other numbers."""

    tau: ArrayLike  # sampling period, in the plant's unit of time
    delay: ArrayLike = 0.0  # [sampling periods]
    derivative: str = "measured"  # "measured" | "backward" | "filtered"
    filter_time: float | None = None  # [sampling periods], needed by "filtered" alone

    @property
    def memory(self) -> int:
        """How many numbers the derivative keeps. Raises ValueError for an unknown derivative or a wrong filter time."""
        if self.derivative not in MEMORY:
            raise ValueError(f"derivative {self.derivative!r} is none of {', '.join(map(repr, DERIVATIVES))}")
        lag = self.filter_time
        if self.derivative == "filtered" and not (lag is not None and 0.0 <= lag < math.inf):
            raise ValueError(f"derivative 'filtered' needs a filter time of 0 or more sampling periods, not {lag}")
        return MEMORY[self.derivative]

    @property
    def kept(self) -> float:
        """Share of the last estimate that the derivative keeps; 0.0 without a filter. ValueError as `memory`."""
        if self.memory < MEMORY["filtered"] or not self.filter_time:
            return 0.0
        return math.exp(-1.0 / self.filter_time)
