"""Where runs of the whole actuator and linear theory part, and why: by further runs, not by opinion.

Linear theory is that of the smallest swing about (0, 0, 1/2, 1/2).
"""

import numpy as np
from numpy.typing import NDArray

from controller.stability.actuator.oscillation import (
    Flags,
    Loops,
    Oscillations,
    oscillations,
)
from controller.stability.chart import unstable_multipliers

SMALL = 1e-2, 1e-4, 1e-6  # of alpha, starts of the runs that tell why
LONGER, WIDER = 16.0, 10.0  # times their length, their limit
CAUSES = {
    "": "run and theory agree",
    "hard": "a swing keeps itself up beside a stable rest: let go nearer to its target the piston comes to rest",
    "saturated": "the same, and with a valve ten times as wide it would die away",
    "slow": "too near the edge for the length of the run: sixteen times longer it agrees",
    "damped": "the piston came home with the valve open, which damped its swing to next to nothing; let go at 0.01 "
    "alpha it swings as theory says",
    "unexplained": "none of the causes that are tried",
}


def oscillates_by_theory(loops: Loops) -> Flags:
    """Is a multiplier not inside the unit circle?"""
    outside = unstable_multipliers(*loops[:4], loops.timing)
    return np.broadcast_to(outside > 0, np.broadcast_shapes(*(np.shape(value) for value in loops[:9])))


def causes(loops: Loops, found: Oscillations) -> NDArray[np.str_]:
    """For each run, a key of CAUSES."""
    shape = found.oscillates.shape
    flat = loops._replace(**{name: np.broadcast_to(np.asarray(v, float), shape).ravel() for name, v in _numbers(loops)})
    theory, said = oscillates_by_theory(flat), np.full(found.oscillates.size, "", dtype="<U11")
    for which in np.flatnonzero(theory != found.oscillates.ravel()):
        one = flat._replace(**{name: values[which] for name, values in _numbers(flat)})
        limited = float(found.saturated.flat[which]) > 0.0
        said[which] = _lives_on(one, limited) if found.oscillates.flat[which] else _dies(one)
    return said.reshape(shape)


def _numbers(loops: Loops) -> list[tuple[str, np.ndarray]]:
    return [(name, np.asarray(value)) for name, value in zip(Loops._fields[:9], loops[:9], strict=True)]


def _lives_on(loop: Loops, limited: bool) -> str:
    """Theory says stable."""
    if not oscillations(loop._replace(start=SMALL)).oscillates.all():
        wider = loop._replace(limit=WIDER * np.asarray(loop.limit))
        return "saturated" if limited and not oscillations(wider).oscillates else "hard"
    return "slow" if not oscillations(loop, LONGER).oscillates else "unexplained"


def _dies(loop: Loops) -> str:
    """Theory says unstable."""
    later = oscillations(loop, LONGER)
    if later.oscillates:
        return "slow"
    faint = later.amplitude < SMALL[0] * np.asarray(loop.alpha)
    return "damped" if faint and oscillations(loop._replace(start=SMALL[0])).oscillates else "unexplained"
