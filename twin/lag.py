"""First-order lag, exact over a step for an input that is straight within it. T y' = u - y gives, with e = exp(-h/T),

    y_1 = e y_0 + ((1 - e) T/h - e) u_0 + (1 - (1 - e) T/h) u_1,

three shares that are positive and add up to one: whatever T/h, the output stays between what it was and its inputs.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined


class Lag(NamedTuple):
    """Shares of the output and the input before a step, and of the input after it."""

    kept: float
    before: float
    after: float


def lag_over(steps: float) -> Lag:
    """The lag with a time constant of so many steps, T/h; 0.0: the output is the input."""
    if steps == 0.0:
        return Lag(0.0, 0.0, 1.0)
    kept = math.exp(-1.0 / steps)
    mean = -math.expm1(-1.0 / steps) * steps
    return Lag(kept, mean - kept, 1.0 - mean)


@inlined
def follow(output: float, before: float, after: float, lag: Lag) -> float:
    """The output of a lag a step later; before, after: its input then and now."""
    return lag.kept * output + lag.before * before + lag.after * after
