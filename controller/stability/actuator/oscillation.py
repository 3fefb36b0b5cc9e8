"""When a run of the whole actuator counts as oscillating: the one criterion, and runs of many loops judged by it.

The piston starts at rest, displaced. The run, PERIODS sampling periods or LASTING units of time, whichever is longer,
is cut into thirds. The loop oscillates if in the last third the position goes up and down about the middle of what it
did in the middle third, peak to peak by no less than KEPT of that; or if the piston comes to an end of the cylinder.
It is stable if the swing has fallen below FALLEN of the middle third's. Otherwise it may still be on its way, or
falling to a swing that stays: it is run again, four times as long, and after LENGTHENED times counts as stable. No
noise hides a swing here, so it counts however small it is; FLOOR is but rounding. So the answer is that of the sign of
the growth, within ln(KEPT) over a third of the run.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from controller.stability.actuator.constant_command import SimulatedActuator
from controller.stability.actuator.model import Actuator
from controller.stability.actuator.simulate import (
    ALPHA,
    END,
    LOST,
    TOLERANCE,
    Sampled,
    Tally,
    controller,
    follow,
)
from controller.stability.plant import Array
from controller.stability.timing import Timing
from twin.kernel import allocating_kernel

PERIODS, LASTING = 300, 600.0  # sampling periods; 1/omega, some 130 swings of the oil spring
KEPT, FALLEN = 0.98, 0.1  # of the middle third's swing
LENGTHENED = 3  # times at most
FLOOR = 1e-9  # of alpha, peak to peak
START = 1.0  # of alpha, where the piston is let go: there the pressures begin to feel the swing
Flags = NDArray[np.bool_]


class Loops(NamedTuple):
    """Loops to be run; every number may be an array, and they broadcast."""

    s: ArrayLike
    d: ArrayLike
    k: ArrayLike
    gamma: ArrayLike
    tau: ArrayLike
    delay: ArrayLike  # sampling periods
    alpha: ArrayLike
    limit: ArrayLike  # of |u|
    start: ArrayLike  # displacement of the piston, in units of alpha
    derivative: str  # "measured" | "backward" | "filtered"
    filter_time: float | None  # sampling periods

    @property
    def timing(self) -> Timing:
        """Times of the controllers."""
        return Timing(self.tau, self.delay, self.derivative, self.filter_time)


PLAIN = Loops(0.5, 0.0, 0.1, 0.23, 3.0, 0.0, ALPHA, 1.0, START, "measured", None)  # amid the thesis's digital charts
ORDER = Loops._fields[:9]  # of a row of numbers


class Oscillations(NamedTuple):
    """What runs did, arrays of one shape."""

    oscillates: Flags
    ends: Flags  # the piston came to an end of the cylinder; there the run is over
    amplitude: Array  # half of peak to peak, last third, in chamber lengths; 1.0 at an end
    growth: Array  # swing of the last third over that of the middle one; inf at an end
    angle: Array  # [rad per sampling period], 0 .. pi: by how often samples change sides; compare |arg mu|
    frequency: Array  # [rad omega], of the position itself, by its upward passages of the middle; 0.0 without two
    saturated: Array  # share of the last third's samples that found the valve at its limit


def oscillations(loops: Loops, longer: float = 1.0, laminar: float = 0.0) -> Oscillations:
    """Run and judge loops, in the shape to which their numbers broadcast.

    longer: by which the length of the runs is multiplied; laminar: as in `constant_command`. Raises ValueError for a
    wrong number, RuntimeError where a run's steps vanish.
    """
    numbers = np.broadcast_arrays(*(np.asarray(value, float) for value in loops[:9]))
    kept = checked(loops)
    rows = np.array([values.ravel() for values in numbers]).T.copy()
    periods = np.ceil(longer * np.maximum(PERIODS, LASTING / rows[:, 4])).astype(np.int64)
    found = _judged(rows, periods, loops.derivative == "measured", kept, laminar)
    for _ in range(LENGTHENED):
        falling = np.flatnonzero(~found.oscillates & (found.growth >= FALLEN))
        periods[falling] *= 4
        again = _judged(rows[falling], periods[falling], loops.derivative == "measured", kept, laminar)
        for old, new in zip(found, again, strict=True):
            old[falling] = new
    return Oscillations._make(part.reshape(numbers[0].shape) for part in found)


def _judged(rows: Array, periods: NDArray[np.int64], measured: bool, kept: float, laminar: float) -> Oscillations:
    n = len(rows)
    seen = Tally(np.zeros((n, 3, 2)), np.zeros((n, 3, 4)), np.zeros((n, 3, 3)))
    outcome, none = np.zeros(n, np.int64), (np.empty((0, 4)), np.empty(0))
    run_all(rows, periods, measured, kept, float(laminar), TOLERANCE, none, seen, outcome)
    if np.any(outcome == LOST):
        row = dict(zip(ORDER, rows[np.argmax(outcome == LOST)].tolist(), strict=True))
        raise RuntimeError(f"the steps of a run vanished: {row}; set `laminar`")
    return judge(seen, outcome == END, rows[:, ORDER.index("alpha")])


def checked(loops: Loops) -> float:
    """How much of its last estimate the derivative keeps; raises ValueError for a number that no loop has."""
    numbers = {name: np.asarray(value, float) for name, value in zip(ORDER, loops[:9], strict=True)}
    for name, least in (("k", 0.0), ("gamma", 0.0), ("alpha", np.nextafter(0.0, 1.0))):
        wrong = numbers[name][~((numbers[name] >= least) & np.isfinite(numbers[name]))]
        if wrong.size:
            raise ValueError(f"{name} {wrong.flat[0]} must be {'above' if least else 'at least'} 0, and finite")
    far = np.abs(numbers["start"] * numbers["alpha"])
    if not np.all(far < 1.0):
        raise ValueError(f"start {far.max():g} chamber lengths from the middle: the cylinder ends at 1")
    for extreme in (np.min, np.max):
        s, d, tau, delay, limit = (float(extreme(numbers[name])) for name in ("s", "d", "tau", "delay", "limit"))
        controller(s, d, loops.timing._replace(tau=tau, delay=delay), limit)
    return loops.timing.kept


@allocating_kernel
def run_all(rows, periods, measured, kept, laminar, tolerance, plain, seen: Tally, outcome):
    """Run the loop of each row, ORDER."""
    for i in range(len(rows)):
        s, d, k, gamma, tau, delay, alpha, limit, start = rows[i]
        plant = SimulatedActuator(Actuator(alpha, gamma, k), laminar, tolerance)
        loop = Sampled(s, d, tau, delay, measured, kept, limit)
        y = np.array([alpha * start, 0.0, 0.5, 0.5])
        seen.extremes[i, :, 0], seen.extremes[i, :, 1] = np.inf, -np.inf
        of_run = Tally(seen.extremes[i], seen.passages[i], seen.turns[i])
        outcome[i] = follow(y, plant, loop, periods[i], plain[0], plain[1], of_run)


def judge(seen: Tally, ends: Flags, alpha: Array) -> Oscillations:
    """The criterion."""
    swing = np.where(ends[:, None], 2.0, seen.extremes[..., 1] - seen.extremes[..., 0])
    samples, turned, limited = np.moveaxis(seen.turns[:, 2], -1, 0)
    count, first, last, _ = np.moveaxis(seen.passages[:, 2], -1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        growth = np.where(ends, np.inf, np.nan_to_num(swing[:, 2] / swing[:, 1], nan=0.0))
        frequency = np.where(count > 1.0, 2.0 * np.pi * (count - 1.0) / (last - first), 0.0)
        angle, saturated = np.nan_to_num(np.pi * turned / (samples - 1.0)), np.nan_to_num(limited / samples)
    oscillates = ends | ((count > 1.0) & (swing[:, 2] >= FLOOR * alpha) & (growth >= KEPT))
    return Oscillations(oscillates, ends, 0.5 * swing[:, 2], growth, angle, frequency, saturated)
