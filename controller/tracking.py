"""How a run follows a reference that moves: the lag of a sine or a trajectory, and a sine's amplitude ratio."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from controller.stretches import moving

Array = npt.NDArray[np.floating]

LEAST_PERIODS = 2  # of a sine: the first is the transient's
LEAST_MOVING = 30  # samples of another motion


class Tracking(NamedTuple):
    """NaN: the reference does not move so."""

    phase_lag: float  # [rad], > 0 behind the reference
    time_lag: float  # [s], > 0 behind it
    amplitude_ratio: float


NOTHING = Tracking(math.nan, math.nan, math.nan)


def tracking(time: Array, reference: Array, position: Array, frequency: float = math.nan) -> Tracking:
    """Lag and amplitude ratio of the position; `frequency` [Hz] of a reference that is a sine, else NaN."""
    moves = np.flatnonzero(moving(reference)) if not np.isnan(reference).any() else np.array([], dtype=int)
    if moves.size < LEAST_MOVING:
        return NOTHING
    if frequency == frequency:
        since = slice(moves[0] - 1, None)
        return _of_sine(time[since], reference[since], position[since], frequency)
    return NOTHING._replace(time_lag=_of_motion(time, reference, position, moves))


def _of_sine(time: Array, reference: Array, position: Array, frequency: float) -> Tracking:
    """Least squares at the known frequency, over whole periods, the first third of which is left to the transient."""
    periods = math.floor((time[-1] - time[0]) * frequency * (1.0 + 1e-9))
    if periods < LEAST_PERIODS:
        return NOTHING
    kept = periods - max(1, periods // 3)
    window = time >= time[-1] - kept / frequency - 1e-9
    wanted, found = (_phasor(time[window], signal[window], frequency) for signal in (reference, position))
    if abs(wanted) == 0.0:
        return NOTHING
    response = found / wanted
    lag = -math.atan2(response.imag, response.real)
    lag += 2.0 * math.pi * (lag < -0.5 * math.pi)  # a piston more than a quarter ahead is far behind
    return Tracking(lag, lag / (2.0 * math.pi * frequency), abs(response))


def _phasor(time: Array, signal: Array, frequency: float) -> complex:
    """Amplitude and phase of a signal at a frequency, beside its mean and drift."""
    turn = 2.0 * math.pi * frequency * (time - time[0])
    columns = np.column_stack([np.cos(turn), np.sin(turn), np.ones(time.size), time - time[0]])
    real, imaginary = np.linalg.lstsq(columns, signal, rcond=None)[0][:2]
    return complex(real, -imaginary)


def _of_motion(time: Array, reference: Array, position: Array, moves: npt.NDArray[np.intp]) -> float:
    """The lag at which error = lag * velocity of the reference fits best; the first third of each motion is left out.

    Exact for a ramp that has settled; of a trajectory the lag of its slow parts.
    """
    speed = np.gradient(reference, time)
    motions = np.split(moves, np.flatnonzero(np.diff(moves) > 1) + 1)
    late = np.concatenate([motion[motion.size // 3 :] for motion in motions])
    e, v = (reference - position)[late], speed[late]
    return float(np.dot(e, v) / np.dot(v, v)) if np.dot(v, v) > 0.0 else math.nan
