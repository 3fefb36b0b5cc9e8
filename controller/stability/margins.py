"""How far a sampled loop is from the edge: in gain, in derivative gain, in delay; what happens there; gains to take."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controller.stability.crossing import Onset, classify, first_loss, is_stable, multipliers, named, stable_ranges
from controller.stability.plant import Array, Plant
from controller.stability.sampled import SampledLoop, closed, sampled_loop
from controller.stability.timing import Timing

SCAN = 0.02  # of a sampling period, between the delays tried
LONGEST = 10.0  # sampling periods of further delay that are tried
GAIN_MARGIN, DELAY_MARGIN = 2.0, 1.0  # of suggested gains; the latter in sampling periods
LOWERED = 0.95  # a gain whose delay margin is too small, from one try to the next


class Margins(NamedTuple):
    """Of one loop at its gains s and d."""

    stable: bool
    critical: Onset | None  # as s grows from 0 at this d; None: never lost, gain 0.0: none to lose
    gain_margin: float  # critical over own s, d unchanged; below 1.0 for one that is too high
    derivative: tuple[float, float]  # stable range of d around the own one, from 0 up; NaN if the loop is unstable
    delay_margin: float  # further delay that it tolerates [sampling periods]; 0.0 if unstable, inf beyond `longest`
    dominant: Onset  # what grows fastest or dies most slowly at these gains


def margins(plant: Plant, s: float, d: float, timing: Timing, longest: float = LONGEST) -> Margins:
    """All of them for one plant, sampled as `sampled_loop` says; one period, one delay. ValueError as there."""
    loop = sampled_loop(plant, timing)
    critical, stable = loop_onset(loop, d), bool(is_stable(closed(loop, s, d)))
    late = delay_margin(plant, s, d, timing, longest) if stable else 0.0
    ratio = math.inf if critical is None or s == 0.0 else critical.gain / s
    return Margins(stable, critical, ratio, derivative_range(loop, s, d), late, dominant(loop, s, d))


def loop_onset(loop: SampledLoop, d: float) -> Onset | None:
    """How stability is lost as s grows from 0 at this d; None: it is never lost. gain 0.0: there is none to lose.

    Frequency [rad per unit of time] is angle/tau; a flip starts at half the sampling frequency.
    """
    matrix = closed(loop, 0.0, d)
    gain = first_loss(matrix, loop.entry, loop.position)
    return classify(gain, matrix, loop.entry, loop.position) if np.isfinite(gain) else None


def dominant(loop: SampledLoop, s: float, d: float) -> Onset:
    """The largest multiplier at these gains, its kind and angle; gain is s."""
    mu = multipliers(closed(loop, s, d))
    return named(s, complex(mu[np.argmax(np.abs(mu))]))


def gain_margin(loop: SampledLoop, s: float, d: float) -> tuple[float, float]:
    """Factors (below, above) by which both gains may change together while the loop stays stable, s and d at 1.

    (0.0, ...) if any smaller gain will do, (..., inf) if any larger one will. ValueError for an unstable loop.
    """
    row = s * loop.position + d * loop.velocity
    for low, high in stable_ranges(loop.free, loop.entry, row):
        if low < 1.0 < high:
            return low, high
    raise ValueError(f"gains s {s}, d {d} are unstable already and have no margin; lower them below the critical gain")


def derivative_range(loop: SampledLoop, s: float, d: float) -> tuple[float, float]:
    """Ends of the stable range of derivative gains around d >= 0, s unchanged; (NaN, NaN) for an unstable loop."""
    matrix = closed(loop, s, 0.0)
    if not is_stable(closed(loop, s, d)):
        return math.nan, math.nan
    ranges = stable_ranges(matrix, loop.entry, loop.velocity)
    return next(((low, high) for low, high in ranges if low <= d <= high), (d, d))


def delay_margin(plant: Plant, s: float, d: float, timing: Timing, longest: float = LONGEST) -> float:
    """Further delay [sampling periods] that makes the loop unstable; inf if none up to `longest` does.

    Ranges of instability narrower than 0.02 periods may be passed over. ValueError for an unstable loop.
    """

    def stable(more: Array) -> NDArray[np.bool_]:
        return _stable_later(plant, s, d, timing, more)

    if not stable(np.zeros(1))[0]:
        raise ValueError(
            f"gains s {s}, d {d} are unstable at delay {timing.delay} already and have no margin; lower them"
        )
    for period in range(math.ceil(longest)):  # one at a time: most loops are lost early
        more = np.minimum(period + SCAN * np.arange(1, round(1.0 / SCAN) + 1), longest)
        if not (good := stable(more)).all():
            lost = float(more[np.argmin(good)])
            return _halved(lambda late: bool(stable(np.array([late]))[0]), lost - SCAN, lost)
    return math.inf


def _stable_later(plant: Plant, s: float, d: float, timing: Timing, more: Array) -> NDArray[np.bool_]:
    """Is the loop stable with each of these further delays? Those that give matrices of one size are done together."""
    delays = np.asarray(timing.delay, float) + more
    out, sizes = np.empty(delays.shape, bool), np.ceil(delays)
    for size in np.unique(sizes):
        at = sizes == size
        out[at] = is_stable(closed(sampled_loop(plant, timing._replace(delay=delays[at])), s, d))
    return out


def _halved(stable, low: float, high: float) -> float:
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return high


def suggested_gain(plants: Sequence[Plant], d: float, timing: Timing) -> float:
    """A gain s with GAIN_MARGIN and DELAY_MARGIN for each of the plants: half the least critical one, or less.

    0.0 where there is none above a hundredth of the critical one; inf where none is critical.
    """

    def tolerates_delay(s: float) -> bool:
        return all(
            bool(_stable_later(plant, s, d, timing, more).all())
            for more in (np.full(1, DELAY_MARGIN), np.arange(0.0, DELAY_MARGIN, SCAN))
            for plant in plants
        )

    onsets = [loop_onset(sampled_loop(plant, timing), d) for plant in plants]
    gain = least = min(math.inf if onset is None else onset.gain for onset in onsets) / GAIN_MARGIN
    while 0.0 < gain < math.inf and not tolerates_delay(gain):
        gain = gain * LOWERED if gain > 2e-2 * least else 0.0
    return gain
