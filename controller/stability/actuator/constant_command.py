"""The actuator at a constant command: where it goes, and how that depends on where it was and on the command.

Dormand and Prince's pair 5(4); Rodas, 4(3), where a wide open valve makes that stiff. A step is bounded by its error,
absolute in supply pressures, and by LONGEST, so that an oscillation much smaller than the tolerance keeps
its size, too. The variational equations may go along, then always explicitly.
"""

import math
from typing import NamedTuple

import numpy as np

from controller.stability.actuator.dormand_prince import error_of, stage
from controller.stability.actuator.model import (
    Actuator,
    rates,
    root,
    root_slope,
)
from controller.stability.actuator.stiff import relaxation, stiff_step_by
from twin.kernel import inlined, kernel

STATE = 4  # width of a row: y alone
WHOLE = 24  # y, then d y/d(y0, u) row by row, (4, 5)
LONGEST = 0.2  # of a step [1/omega]: the oil spring, sqrt2, keeps its amplitude to 1.4e-7 a step, (sqrt2 h)^6/3600
STIFF = 2.0  # times the pressures' own rate, beyond which a step is not explicit; 3.3 is where that one ends
MOST = 10_000_000  # steps at one command
SHORTEST = 1e-12  # what a step may shrink to before the run is given up


class SimulatedActuator(NamedTuple):
    """A plant and how closely it is followed."""

    actuator: Actuator
    laminar: float  # drop below which the valve's edges are laminar; 0.0: the pure root
    tolerance: float  # of a step, in units of the supply pressure


class Observed(NamedTuple):
    """What was observed in a part of a run; arrays of one number, or two, to be filled."""

    extremes: np.ndarray  # lowest and highest position
    passages: np.ndarray  # upward through a position: how many, when the first, the last; and that position


@inlined
def derive(w, out, width, u, plant: SimulatedActuator):
    """Rates of a row at the command u, (5.7) and its variational equations."""
    alpha, gamma, k = plant.actuator
    y1, y2, y3, y4 = w[0], w[1], w[2], w[3]
    a, b = max(u, 0.0), max(-u, 0.0)
    out[0], out[1], out[2], out[3] = rates(y1, y2, y3, y4, a, b, plant.actuator, plant.laminar)
    if width == 4:
        return
    to3, to4 = gamma / (alpha * (1.0 + y1)), gamma / (alpha * (1.0 - y1))
    own3 = own4 = 0.0
    if u > 0.0:
        own3 = -to3 * a * root_slope(1.0 - y3, plant.laminar)
        own4 = -to4 * a * root_slope(y4, plant.laminar)
    elif u < 0.0:
        own3 = -to3 * b * root_slope(y3, plant.laminar)
        own4 = -to4 * b * root_slope(1.0 - y4, plant.laminar)
    by3 = to3 * root(1.0 - y3 if u >= 0.0 else y3, plant.laminar)
    by4 = -to4 * root(y4 if u >= 0.0 else 1.0 - y4, plant.laminar)
    for j in range(5):
        v1, v2, v3, v4 = w[4 + j], w[9 + j], w[14 + j], w[19 + j]
        du = 1.0 if j == 4 else 0.0
        out[4 + j] = v2
        out[9 + j] = alpha * (v3 - v4) - k * v2
        out[14 + j] = -out[2] / (1.0 + y1) * v1 - to3 / gamma * v2 + own3 * v3 + by3 * du
        out[19 + j] = out[3] / (1.0 - y1) * v1 + to4 / gamma * v2 + own4 * v4 + by4 * du


@inlined
def step_by(w, width, size, u, plant: SimulatedActuator, stages, trial):
    """One step from w (with its rates in stages[0]) into trial; returns the error of the state over the tolerance."""
    for i in range(1, 7):
        stage(i, w, width, size, stages, trial)
        derive(trial, stages[i], width, u, plant)
    worst = 0.0
    for n in range(4):
        worst = max(worst, error_of(n, size, stages) / (plant.actuator.alpha if n < 2 else 1.0))
    return worst / plant.tolerance


@kernel
def integrate(w, width, u, begin, duration, size, plant: SimulatedActuator, stages, trial, seen: Observed):
    """Follow w, in place, for a duration from the time `begin` at the command u, with steps of about `size` at first.

    Returns the size for the steps to come; 0.0 where steps vanish or MOST of them do not suffice.
    """
    time, fresh = 0.0, False  # fresh: stages[0] has the rates at w
    for _ in range(MOST):
        if time >= duration:
            return size
        rest = duration - time
        step = rest / math.ceil(rest / min(size, LONGEST))
        own3, own4 = relaxation(w, u, plant)
        stiff = width == 4 and step * max(-own3, -own4) > STIFF
        if stiff:
            error, power = stiff_step_by(w, step, u, plant, stages, trial), -0.25
        else:
            if not fresh:
                derive(w, stages[0], width, u, plant)
            error, power = step_by(w, width, step, u, plant, stages, trial), -0.2
        fresh = not stiff
        if not (error <= 1.0 and abs(trial[0]) < 1.0):
            size = step * (max(0.1, 0.9 * error**power) if 1.0 < error < math.inf else 0.1)
            if size < SHORTEST:
                return 0.0
            continue
        if w[0] < seen.passages[3] <= trial[0]:
            passed = begin + time + step * (seen.passages[3] - w[0]) / (trial[0] - w[0])
            seen.passages[1] = passed if seen.passages[0] == 0.0 else seen.passages[1]
            seen.passages[0] += 1.0
            seen.passages[2] = passed
        time = duration if step == rest else time + step
        for n in range(width):
            w[n], stages[0, n] = trial[n], stages[6, n]  # the last stage of an explicit step is the first of the next
        seen.extremes[0] = min(seen.extremes[0], w[0])
        seen.extremes[1] = max(seen.extremes[1], w[0])
        size = step * max(0.2, min(5.0, 0.9 * max(error, 1e-10) ** power))
    return 0.0
