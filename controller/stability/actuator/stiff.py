"""A step of the actuator at a constant command, for a chamber that an open valve fills faster than the piston moves.

Near no drop the root's slope is steep, and an explicit step short for nothing. Rodas, of Hairer and Wanner (Solving
Ordinary Differential Equations II, IV.7): order 4(3), L-stable, six stages with one matrix. That matrix, 1/(g h) - J,
is solved by hand: the pressures by the piston, the piston by its speed, the speed alone.
"""

import numpy as np

from controller.stability.actuator.model import rates, root_slope
from twin.kernel import inlined

GAMMA = 0.25
A = np.zeros((6, 6))  # of the points at which stages are evaluated
A[1, :1] = 1.544
A[2, :2] = 0.9466785280815826, 0.2557011698983284
A[3, :3] = 3.314825187068521, 2.896124015972201, 0.9986419139977817
A[4, :4] = 1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950
A[5, :5] = 1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0
C = np.zeros((6, 6))  # of the stages before, over the step
C[1, :1] = -5.6688
C[2, :2] = -2.430093356833875, -0.2063599157091915
C[3, :3] = -0.1073529058151375, -9.594562251023355, -20.47028614809616
C[4, :4] = 7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160
C[5, :5] = 8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054


@inlined
def relaxation(w, u, plant):
    """How fast each pressure settles while the piston stands, d y3'/d y3 and d y4'/d y4, not above 0."""
    alpha, gamma, _k = plant.actuator
    to3, to4 = gamma * abs(u) / (alpha * (1.0 + w[0])), gamma * abs(u) / (alpha * (1.0 - w[0]))
    if u == 0.0:
        return 0.0, 0.0
    high, low = (w[2], 1.0 - w[3]) if u < 0.0 else (1.0 - w[2], w[3])
    return -to3 * root_slope(high, plant.laminar), -to4 * root_slope(low, plant.laminar)


@inlined
def stiff_step_by(w, size, u, plant, stages, trial):
    """One step from w into trial, with U_1 .. U_6 left in stages; returns the error of the state over the tolerance."""
    alpha, _gamma, k = plant.actuator
    a, b = max(u, 0.0), max(-u, 0.0)
    own3, own4 = relaxation(w, u, plant)
    _r1, _r2, rate3, rate4 = rates(w[0], w[1], w[2], w[3], a, b, plant.actuator, plant.laminar)
    by1_3, by1_4 = -rate3 / (1.0 + w[0]), rate4 / (1.0 - w[0])
    by2_3, by2_4 = -1.0 / (alpha * (1.0 + w[0])), 1.0 / (alpha * (1.0 - w[0]))
    g = 1.0 / (GAMMA * size)
    to3, to4 = 1.0 / (g - own3), 1.0 / (g - own4)
    of_speed = g + k - alpha * (to3 * (by2_3 + by1_3 / g) - to4 * (by2_4 + by1_4 / g))
    for i in range(6):
        for n in range(4):
            trial[n] = w[n]
            for j in range(i):
                trial[n] += A[i, j] * stages[j, n]
        b1, b2, b3, b4 = rates(trial[0], trial[1], trial[2], trial[3], a, b, plant.actuator, plant.laminar)
        for j in range(i):
            share = C[i, j] / size
            b1 += share * stages[j, 0]
            b2 += share * stages[j, 1]
            b3 += share * stages[j, 2]
            b4 += share * stages[j, 3]
        right = b2 + alpha * (to3 * (b3 + by1_3 * b1 / g) - to4 * (b4 + by1_4 * b1 / g))
        v2 = right / of_speed
        v1 = (b1 + v2) / g
        stages[i, 0], stages[i, 1] = v1, v2
        stages[i, 2] = to3 * (b3 + by1_3 * v1 + by2_3 * v2)
        stages[i, 3] = to4 * (b4 + by1_4 * v1 + by2_4 * v2)
    for n in range(4):
        trial[n] += stages[5, n]
    motion, pressure = max(abs(stages[5, 0]), abs(stages[5, 1])), max(abs(stages[5, 2]), abs(stages[5, 3]))
    return max(motion / alpha, pressure) / plant.tolerance
