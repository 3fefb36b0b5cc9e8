"""Control metrics of a recorded run.

Position may be the true or the measured one: the caller chooses. The reference must be evaluated on the time base of
the signals; one held over a slower sample period looks like a staircase of steps.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from controller.bands import Metrics

Array = npt.NDArray[np.floating]

# seven steps of a 12 bit card over 300 mm: neither its noise nor a piston creeping within its stick reaches that
LIMIT_CYCLE_THRESHOLD = 0.54e-3  # [m], peak to peak; 0.2 % of the 270 mm stroke
LEAST_SAMPLES = 10  # of a constant stretch
BAND = 0.02  # of the step, for settling


class Signals(NamedTuple):
    time: Array  # [s], evenly spaced
    position: Array  # [m]
    reference: Array  # [m]
    p1: Array  # [Pa]
    p_lower: Array  # [Pa]
    p_upper: Array  # [Pa]
    spool: Array  # true spool position, -1..1


class Stretch(NamedTuple):
    """Samples start..stop-1, all of one reference value."""

    start: int
    stop: int
    steps: bool  # begins with a jump from another constant value


def measure(signals: Signals, threshold: float = LIMIT_CYCLE_THRESHOLD) -> Metrics:
    """Metrics of one run; NaN where a metric has no meaning (no step, never risen, never settled, never constant).

    Of several steps the worst counts. `threshold` [m]: smallest peak to peak of a limit cycle, looked for in the last
    constant stretch. Raises ValueError for signals of unequal length or without samples.
    """
    if len({column.shape for column in signals}) != 1 or signals.time.ndim != 1 or signals.time.size == 0:
        raise ValueError(f"signals must be equally long and not empty, but have {[c.shape for c in signals]} samples")
    error = signals.reference - signals.position
    stretches = constant_stretches(signals.reference)
    last = slice(stretches[-1].start, stretches[-1].stop) if stretches else slice(0, 0)
    amplitude, frequency = limit_cycle(signals.time[last], error[last], threshold)
    rise, overshoot, settling = _worst_step(signals, stretches)
    return Metrics(
        rise_time=rise,
        overshoot=overshoot,
        settling_time=settling,
        steady_error=_end_mean(error[last]),
        rms_error=float(np.sqrt(np.mean(error**2))),
        max_error=float(np.max(np.abs(error))),
        limit_cycle_amplitude=amplitude,
        limit_cycle_frequency=frequency,
        peak_p1=float(signals.p1.max()),
        peak_p_lower=float(signals.p_lower.max()),
        peak_p_upper=float(signals.p_upper.max()),
        min_p_lower=float(signals.p_lower.min()),
        min_p_upper=float(signals.p_upper.min()),
        valve_travel=float(np.abs(np.diff(signals.spool)).sum()),
    )


def constant_stretches(reference: Array) -> list[Stretch]:
    """Stretches of at least 10 equal samples; the run's first may be shorter and still be stepped from."""
    changes = np.flatnonzero(np.diff(reference)) + 1
    edges = np.concatenate(([0], changes, [reference.size]))
    held = np.diff(edges) >= LEAST_SAMPLES
    before = np.concatenate(([False], held[:-1]))
    before[1:2] = True
    return [Stretch(int(edges[k]), int(edges[k + 1]), bool(before[k])) for k in np.flatnonzero(held)]


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


def limit_cycle(time: Array, error: Array, threshold: float) -> tuple[float, float]:
    """Amplitude [m] and frequency [Hz] of a sustained oscillation in the last 60 % of a stretch, else (0, 0)."""
    if error.size < LEAST_SAMPLES:
        return 0.0, 0.0
    start = error.size - int(0.6 * error.size)
    e = _detrended(error[start:])
    early, late, whole = np.ptp(e[: e.size // 2]), np.ptp(e[e.size // 2 :]), float(np.ptp(e))
    if whole <= threshold or late < 0.7 * early:  # too small, or dying away
        return 0.0, 0.0
    frequency = _regular_frequency(time[start:], e, hysteresis=whole / 8.0)
    return (0.5 * whole, frequency) if frequency > 0.0 else (0.0, 0.0)


def _detrended(error: Array) -> Array:
    """Error without its linear trend, about the middle of its extremes: a lopsided cycle hardly crosses its mean."""
    x = np.arange(error.size) - 0.5 * (error.size - 1)
    w = np.hanning(error.size)  # without it the parts of a period at the ends would tilt the trend
    e = error - x * (np.dot(w * x, error) / np.dot(w * x, x))
    return e - 0.5 * (e.max() + e.min())


def _regular_frequency(time: Array, e: Array, hysteresis: float) -> float:
    """Mean frequency [Hz] of the up-crossings; 0.0 for fewer than 4 crossings or an irregular spacing."""
    far = np.flatnonzero(np.abs(e) > hysteresis)
    side = np.sign(e[far])
    turned = np.flatnonzero(np.diff(side)) + 1
    crossings = _passages(time, e, far[turned], hysteresis * side[turned])
    periods = crossings[2:] - crossings[:-2]  # between crossings of one direction: the two halves may differ
    if crossings.size < 4 or np.std(periods) >= 0.5 * np.mean(periods):
        return 0.0
    up = crossings[side[turned] > 0.0]
    return float((up.size - 1) / (up[-1] - up[0]))
