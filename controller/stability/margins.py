"""How far a sampled loop is from the edge: in gain, in delay; and what happens at the edge."""

import numpy as np

from controller.stability.crossing import Onset, classify, first_loss, is_stable, stable_ranges
from controller.stability.plant import Plant
from controller.stability.sampled import SampledLoop, closed, sampled_loop

SCAN = 0.02  # of a sampling period, between the delays tried


def loop_onset(loop: SampledLoop, d: float) -> Onset | None:
    """How stability is lost as s grows from 0 at this d; None: it is never lost. gain 0.0: there is none to lose.

    Frequency [rad per unit of time] is angle/tau; a flip starts at half the sampling frequency.
    """
    matrix = closed(loop, 0.0, d)
    gain = first_loss(matrix, loop.entry, loop.position)
    return classify(gain, matrix, loop.entry, loop.position) if np.isfinite(gain) else None


def gain_margin(loop: SampledLoop, s: float, d: float) -> tuple[float, float]:
    """Factors (below, above) by which both gains may change together while the loop stays stable, s and d at 1.

    (0.0, ...) if any smaller gain will do, (..., inf) if any larger one will. ValueError for an unstable loop.
    """
    row = s * loop.position + d * loop.velocity
    for low, high in stable_ranges(loop.free, loop.entry, row):
        if low < 1.0 < high:
            return low, high
    raise ValueError(f"gains s {s}, d {d} are unstable already and have no margin; lower them below the critical gain")


def delay_margin(
    plant: Plant,
    s: float,
    d: float,
    tau: float,
    delay: float = 0.0,
    derivative: str = "measured",
    filter_time: float | None = None,
    longest: float = 10.0,
) -> float:
    """Further delay [sampling periods] that makes the loop unstable; inf if none up to `longest` does.

    Ranges of instability narrower than 0.02 periods may be passed over. ValueError for an unstable loop.
    """

    def stable(more: float) -> bool:
        loop = sampled_loop(plant, tau, delay + more, derivative, filter_time)
        return bool(is_stable(closed(loop, s, d)))

    if not stable(0.0):
        raise ValueError(f"gains s {s}, d {d} are unstable at delay {delay} already and have no margin; lower them")
    steps = (SCAN * i for i in range(1, round(longest / SCAN) + 1))
    lost = next((more for more in steps if not stable(more)), None)
    return np.inf if lost is None else _halved(stable, lost - SCAN, lost)


def _halved(stable, low: float, high: float) -> float:
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return high
