"""Control metrics of a recorded run.

Position may be the true or the measured one: the caller chooses. The reference must be evaluated on the time base of
the signals; one held over a slower sample period looks like a staircase of steps.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from controller.bands import Metrics
from controller.oscillation import NOISE_FLOOR, oscillation
from controller.stretches import Stretch, constant_stretches, held_stretches
from controller.tracking import tracking

Array = npt.NDArray[np.floating]

LIMIT_CYCLE_THRESHOLD = NOISE_FLOOR  # [m], peak to peak
BAND = 0.02  # of the step, for settling


class Signals(NamedTuple):
    time: Array  # [s], evenly spaced
    position: Array  # [m]
    reference: Array  # [m]
    p1: Array  # [Pa]
    p_lower: Array  # [Pa]
    p_upper: Array  # [Pa]
    spool: Array  # true spool position, -1..1


class Cycle(NamedTuple):
    """The greatest limit cycle of a run and the constant stretch in which it was found; NaN: no stretch to judge."""

    amplitude: float  # [m], half of peak to peak; 0.0: none in any stretch
    frequency: float  # [Hz]; 0.0: none
    begin: float  # [s]
    end: float  # [s]


NOT_APPLICABLE = Cycle(math.nan, math.nan, math.nan, math.nan)


def measure(
    signals: Signals, threshold: float = LIMIT_CYCLE_THRESHOLD, frequency: float = math.nan, moved: bool = False
) -> Metrics:
    """Metrics of one run; NaN where a metric has no meaning (no step, never risen, no stretch to hold, no tracking).

    Of several steps and constant stretches the worst counts. `threshold` [m]: smallest peak to peak of a limit cycle.
    `frequency` [Hz] of a sine to follow. `moved`: the reference did so before these signals begin. Raises ValueError
    for signals of unequal length or without samples.
    """
    if len({column.shape for column in signals}) != 1 or signals.time.ndim != 1 or signals.time.size == 0:
        raise ValueError(f"signals must be equally long and not empty, but have {[c.shape for c in signals]} samples")
    error = signals.reference - signals.position
    held = held_stretches(signals.reference, moved)
    cycle = worst_cycle(signals.time, error, held, threshold)
    rise, overshoot, settling = _worst_step(signals, constant_stretches(signals.reference))
    followed = tracking(signals.time, signals.reference, signals.position, frequency)
    return Metrics(
        rise_time=rise,
        overshoot=overshoot,
        settling_time=settling,
        steady_error=_end_mean(error[held[-1].samples]) if held else math.nan,
        rms_error=float(np.sqrt(np.mean(error**2))),
        max_error=float(np.max(np.abs(error))),
        limit_cycle_amplitude=cycle.amplitude,
        limit_cycle_frequency=cycle.frequency,
        limit_cycle_begin=cycle.begin,
        limit_cycle_end=cycle.end,
        phase_lag=followed.phase_lag,
        time_lag=followed.time_lag,
        amplitude_ratio=followed.amplitude_ratio,
        peak_p1=float(signals.p1.max()),
        peak_p_lower=float(signals.p_lower.max()),
        peak_p_upper=float(signals.p_upper.max()),
        min_p_lower=float(signals.p_lower.min()),
        min_p_upper=float(signals.p_upper.min()),
        valve_travel=float(np.abs(np.diff(signals.spool)).sum()),
    )


def worst_cycle(time: Array, error: Array, held: list[Stretch], threshold: float = LIMIT_CYCLE_THRESHOLD) -> Cycle:
    """The greatest limit cycle of all stretches that are long enough; of the last one where none has any."""
    found = [NOT_APPLICABLE]
    for stretch in held:
        if swing := oscillation(time[stretch.samples], error[stretch.samples], threshold):
            found.append(Cycle(*swing, float(time[stretch.start]), float(time[stretch.stop - 1])))
    return max(found[1:], key=lambda cycle: (cycle.amplitude, cycle.begin), default=NOT_APPLICABLE)


def _worst_step(signals: Signals, stretches: list[Stretch]) -> tuple[float, float, float]:
    responses = [_step_response(signals, stretch) for stretch in stretches if stretch.steps]
    rise, overshoot, settling = np.max(responses, axis=0) if responses else (np.nan, np.nan, np.nan)
    return float(rise), float(overshoot), float(settling)


def _step_response(signals: Signals, stretch: Stretch) -> tuple[float, float, float]:
    """Rise time [s], overshoot, settling time [s] of one step; y goes from 0 to 1 between the two references."""
    window = slice(stretch.start, stretch.stop)
    before, after = signals.reference[stretch.start - 1], signals.reference[stretch.start]
    time, y = signals.time[window], (signals.position[window] - before) / (after - before)
    deviation = np.abs(y - 1.0)
    outside = np.flatnonzero(deviation > BAND)
    inside = int(outside[-1]) + 1 if outside.size else 0
    rise = _first_above(time, y, 0.9) - _first_above(time, y, 0.1)
    return rise, max(float(y.max()) - 1.0, 0.0), _time_at(time, deviation, inside, BAND) - float(time[0])


def _first_above(time: Array, y: Array, level: float) -> float:
    above = y >= level
    return _time_at(time, y, int(np.argmax(above)) if above.any() else y.size, level)


def _time_at(time: Array, y: Array, k: int, level: float) -> float:
    """Time at which y passes the level between samples k-1 and k: the first sample at k = 0, NaN past the end."""
    if k == y.size:
        return float("nan")
    return float(time[0] if k == 0 else _passages(time, y, np.array([k]), np.array([level]))[0])


def _passages(time: Array, y: Array, k: npt.NDArray[np.intp], level: Array) -> Array:
    return time[k - 1] + (time[k] - time[k - 1]) * (level - y[k - 1]) / (y[k] - y[k - 1])


def _end_mean(error: Array) -> float:
    return float(np.mean(error[-max(error.size // 10, 1) :])) if error.size else float("nan")
