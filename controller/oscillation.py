"""Does a loop that should hold still oscillate? Judged by the error about its trend, over one constant stretch.

The first third of the stretch is left to the transient. From the middle and from the last third a trend is taken: a
straight line and, of the spectrum, what turns less than CREEP times in it (cosines, so that the ends need not meet);
that is creep, not a swing. The loop oscillates if in the last third the error goes up and down by more than the noise
floor, about its trend and by itself, and does not die away. Neither a steady period nor a sharp spectral line is asked
for, so bursts and irregular hunting count. A slip does not, nor does a piston that slips on in one direction. A growing
swing counts.

The frequency is that of the autocorrelation's first high peak, sharpened by the spectrum: the swing that is seen, not
the wandering of its middle, and not a harmonic of a lopsided one.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.floating]

NOISE_FLOOR = 0.3e-3  # [m], peak to peak; 0.1 % of the 270 mm stroke, four steps of a 12 bit card over 300 mm
CREEP = 1.0  # periods in a third of a stretch; what is slower is trend
TURNS = 4  # a single slip about its trend turns three times
SHORTEST = 1.0  # [s], of a stretch that is judged: a shorter one is all transient
LEAST_SAMPLES = 18  # of such a stretch
FINER = 8  # lines of the padded spectrum for one of the plain one
DIP, HIGH = 0.2, 0.7  # of the autocorrelation before a peak; of a peak in terms of the greatest


class Swing(NamedTuple):
    """What the error does about its trend in the last third of a stretch."""

    amplitude: float  # [m], half of peak to peak; 0.0: it does not oscillate
    frequency: float  # [Hz]; 0.0: it does not oscillate


STILL = Swing(0.0, 0.0)


def oscillation(time: Array, error: Array, floor: float = NOISE_FLOOR) -> Swing | None:
    """The swing of a stretch; None where it is too short to be judged. floor: [m], peak to peak."""
    if error.size < LEAST_SAMPLES or time[-1] - time[0] < SHORTEST:
        return None
    _, middle, last = np.array_split(error, 3)
    before, e = about_trend(middle), about_trend(last)
    swing = min(float(np.ptp(e)), float(np.ptp(about_line(last))))  # cosines bend at the ends, a line does not
    if swing <= floor or not _goes_on(middle, last, before, e, floor) or dies_away(before, e):
        return STILL
    step = float(time[-1] - time[0]) / (error.size - 1)
    return Swing(0.5 * swing, frequency(e, step))


def about_trend(error: Array) -> Array:
    """Error without a straight line and without the cosines that turn at most CREEP times."""
    turn = np.linspace(0.0, math.pi, error.size)
    slow = [np.ones(error.size), turn, *(np.cos(k * turn) for k in range(1, int(2.0 * CREEP) + 1))]
    basis, _ = np.linalg.qr(np.column_stack(slow))
    return error - basis @ (basis.T @ error)


def about_line(error: Array) -> Array:
    """Error without its slope: without the window, the parts of a period at the ends would tilt it."""
    x, window = np.arange(error.size) - 0.5 * (error.size - 1), np.hanning(error.size)
    return error - x * (np.dot(window * x, error) / np.dot(window * x, x))


def _goes_on(middle: Array, last: Array, before: Array, e: Array, floor: float) -> bool:
    """Do rises and falls follow each other, of the error itself too? Slow or rare ones need the middle third too."""
    if turning_points(last, floor).size < 2:
        return False
    turns = turning_points(e, floor).size
    slow = turns == TURNS - 1 and turning_points(before, floor).size >= TURNS - 1
    return turns >= TURNS or slow or turning_points(middle, floor).size >= 2


def turning_points(e: Array, floor: float) -> npt.NDArray[np.intp]:
    """Samples from which a rise or a fall by more than the floor starts, however irregularly they follow."""
    ends, low, high, side = [], 0, 0, 0
    for k in _extremes(e):
        high, low = (k if e[k] > e[high] else high), (k if e[k] < e[low] else low)
        if side >= 0 and e[high] - e[k] > floor:
            ends.append(high)
            side, low, high = -1, k, k
        elif side <= 0 and e[k] - e[low] > floor:
            ends.append(low)
            side, low, high = 1, k, k
    return np.array(ends, dtype=np.intp)


def _extremes(e: Array) -> list[int]:
    """First and last sample, and those between at which the slope changes its sign."""
    slope = np.sign(np.diff(e))
    moved = np.flatnonzero(slope)
    turned = moved[1:][np.diff(slope[moved]) != 0.0]
    return [0, *turned.tolist(), e.size - 1]


def dies_away(middle: Array, last: Array) -> bool:
    """Does the swing of a stretch shrink from part to part? Its last two thirds, about their trends, in three parts.

    It does if it falls in every part, no slower at the end, and by as much between the thirds; or by a fifth from third
    to third and on within the last. A cycle that is approached from above falls ever more slowly; an irregular one
    rises now and then, or falls in parts of a period only.
    """
    parts = np.array([np.ptp(part) for third in (middle, last) for part in np.array_split(third, 3)])
    if (parts == 0.0).any():
        return False
    early, late = math.log(parts[0] / parts[2]), math.log(parts[3] / parts[5])
    fallen = math.log(np.ptp(middle) / np.ptp(last))  # 1.5 times the fall within a third, of what dies evenly
    steadily = bool((np.diff(parts) < 0.0).all()) and late > 0.05 and late > 0.5 * early and fallen > 0.75 * late
    at_the_end = bool((np.diff(parts[3:]) < 0.0).all()) and parts[5] < 0.85 * parts[3]
    return steadily or (fallen > math.log(1.25) and at_the_end)


def frequency(e: Array, step: float) -> float:
    """Frequency [Hz] of a swing sampled every `step` [s]."""
    power = np.abs(np.fft.rfft(e * np.hanning(e.size), FINER * e.size)) ** 2
    lag = _repetition(e)
    low, high = (0, power.size - 1) if lag is None else (int(FINER * e.size * f / lag) for f in (0.8, 1.25))
    k = int(np.clip(low + np.argmax(power[low : high + 1]), 1, power.size - 2))
    a, b, c = np.log(power[k - 1 : k + 2] + 1e-300)
    offset = 0.5 * (a - c) / (a - 2.0 * b + c) if a + c < 2.0 * b else 0.0
    return float(k + offset) / (FINER * e.size * step)


def _repetition(e: Array) -> int | None:
    """Samples after which a swing resembles itself: the first high peak of its autocorrelation behind a dip."""
    r = autocorrelation(e)[: e.size // 2]
    peaks = np.flatnonzero((r[1:-1] >= r[:-2]) & (r[1:-1] > r[2:])) + 1
    peaks = peaks[r[peaks] - np.minimum.accumulate(r)[peaks] > DIP]
    high = peaks[r[peaks] >= HIGH * r[peaks].max()] if peaks.size else peaks
    return int(high[0]) if high.size else None


def autocorrelation(e: Array) -> Array:
    """Of each lag, -1..1, over what both copies have in common."""
    spectrum = np.fft.rfft(e, 2 * e.size)
    product = np.fft.irfft(np.abs(spectrum) ** 2)[: e.size]
    squares = np.concatenate(([0.0], np.cumsum(e**2)))
    common = squares[e.size : 0 : -1] + squares[-1] - squares[: e.size]
    return 2.0 * product / np.maximum(common, 1e-300)
