"""The explicit Runge-Kutta pair of order 5(4) of Dormand and Prince (1980): its stages and its error estimate.

A step from w, whose rates are in stages[0], is: for i = 1 .. 6, `stage` makes the row at which the caller evaluates
the rates stages[i]. The last such row is the end of the step, and its rates are the first of the next one.
"""

import numpy as np

from twin.kernel import inlined

STAGES = np.zeros((7, 7))
STAGES[1, :1] = 1 / 5
STAGES[2, :2] = 3 / 40, 9 / 40
STAGES[3, :3] = 44 / 45, -56 / 15, 32 / 9
STAGES[4, :4] = 19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729
STAGES[5, :5] = 9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656
STAGES[6, :6] = 35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84
ERROR = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@inlined
def stage(i, w, width, size, stages, out):
    """The row at which stage i of a step from w is evaluated, into out."""
    for n in range(width):
        total = 0.0
        for j in range(i):
            total += STAGES[i, j] * stages[j, n]
        out[n] = w[n] + size * total


@inlined
def error_of(n, size, stages):
    """Estimate of the error of number n of the row after a step."""
    error = 0.0
    for j in range(7):
        error += ERROR[j] * stages[j, n]
    return abs(size * error)
