"""The analysis of an ensemble: a square-root filter that takes one reading after the other, without drawing numbers.

Of N members x_m with mean x and anomalies A, a reading d of variance r that they predict as y_m changes them to

    x + k (d - y) + (A - a k a_y),    k = A a_y'/((N - 1) s),  s = a_y a_y'/(N - 1) + r,  a = 1/(1 + sqrt(r/s))

with a_y the anomalies of y: J. L. Anderson, Monthly Weather Review 129 (2001); Whitaker and Hamill, the same 130
(2002); for readings whose errors are independent it is the transform of Bishop et al. (2001). All of it is a linear
combination of the members, x_m + sum_k A_k D[k, m], so readings of several instants make one D (asynchronous: Sakov et
al., Tellus 62A, 2010), and whatever the members hold, waves in their lines included, comes with it.

Not so the unknowns of the rig. Between N members numbers that have nothing to do with one another are correlated by
1/sqrt(N - 1) or so. What a state loses of its deviation to such chance its motion gives back, an unknown loses it for
good: a thousand readings a second would make it certain of whatever it happens to be. So each unknown is updated beside
the states, by its own regression on each reading, times the share of a correlation c that is not expected of chance,

    1 - (1 - c^2)^2/((N - 2) c^2), 0 where that is negative,

(1 - c^2)^2/(N - 2) being the variance of c. That is a sampling error correction (J. L. Anderson, Monthly Weather Review
140, 2012) in closed form; a correlation of less than 0.2 between 24 members counts as none.

What the readings have said of an unknown is forgotten, what was known of it beforehand is not (stabilised forgetting:
R. Kulhavy, M. B. Zarrop, International Journal of Control 58, 1993). Of a normal distribution of mean m and variance P,
and one of mean 0 and variance P0 beforehand, a share k of the information is kept,

    1/P' = k/P + (1 - k)/P0,    m' = P' k m/P,

so an unknown of which nothing is read goes back to what it was taken for, and its deviation grows no further.
"""

import math

from twin.kernel import kernel

BLOCK = 128  # numbers of a state at a time: they stay in the first cache


@kernel
def combine(y, d, r, weight, turn, out, missed, z) -> None:
    """Fill `out`, D, of the predictions y of readings d, of variances r, a row for each; NaN: not read.

    y is changed to what the members predict afterwards. `missed` is filled with the innovation of each reading over its
    deviation, those before it known: white and of variance 1 as long as the model is right. z: unknowns, a row for each
    member, which are updated. weight, turn: room for N and N x N numbers.
    """
    n = y.shape[1]
    for k in range(n):
        weight[k] = 0.0
        for m in range(n):
            turn[k, m] = 1.0 if k == m else 0.0
    for j in range(len(d)):
        mean, spread = _moments(y[j])
        missed[j] = math.nan
        if math.isnan(d[j]):
            continue
        s = spread + r[j]
        alpha = 1.0 / (1.0 + math.sqrt(r[j] / s))
        gain = 1.0 / ((n - 1) * s)
        away = d[j] - mean
        missed[j] = away / math.sqrt(s)
        _regress(z, y[j], mean, spread, gain * away, gain * alpha)
        for k in range(n):  # V a_y', with V = turn
            along = 0.0
            for m in range(n):
                along += turn[k, m] * (y[j, m] - mean)
            weight[k] += gain * along * away
            for m in range(n):
                turn[k, m] -= alpha * gain * along * (y[j, m] - mean)
        for other in range(len(d) - 1, j - 1, -1):  # itself last: the others need it
            along = 0.0
            for m in range(n):
                along += y[other, m] * (y[j, m] - mean)
            for m in range(n):
                y[other, m] += gain * along * (away - alpha * (y[j, m] - mean))
    for k in range(n):
        for m in range(n):
            out[k, m] = weight[k] + turn[k, m] - (1.0 if k == m else 0.0)


@kernel
def _regress(z, row, mean: float, spread: float, shift: float, shrink: float) -> None:
    """Update unknowns by a reading that is predicted as `row`, as far as more than chance correlates them with it."""
    n = len(row)
    for i in range(z.shape[1]):
        middle, squares = _moments(z[:, i])
        along = 0.0
        for m in range(n):
            along += (z[m, i] - middle) * (row[m] - mean)
        if along == 0.0:
            continue
        square = min(1.0, (along / (n - 1)) ** 2 / (squares * spread))
        kept = max(0.0, 1.0 - (1.0 - square) ** 2 / ((n - 2) * square))
        for m in range(n):
            z[m, i] += kept * along * (shift - shrink * (row[m] - mean))


@kernel
def fade(z, prior, kept: float) -> None:
    """Keep a share of what readings have said of unknowns, in place; a row of z for each member.

    prior: their deviations beforehand; where nothing was uncertain then, there is nothing to go back to.
    """
    n = len(z)
    for i in range(z.shape[1]):
        mean, spread = _moments(z[:, i])
        if spread == 0.0 or prior[i] == 0.0:
            continue
        ratio = kept + (1.0 - kept) * spread / prior[i] ** 2  # P/P'
        for m in range(n):
            z[m, i] = kept * mean / ratio + (z[m, i] - mean) / math.sqrt(ratio)


@kernel
def _moments(row) -> tuple[float, float]:
    """Mean and variance, around the first so that equal numbers have none."""
    n, total, squares = len(row), 0.0, 0.0
    for m in range(n):
        total += row[m] - row[0]
    for m in range(n):
        away = row[m] - row[0] - total / n
        squares += away * away
    return row[0] + total / n, squares / (n - 1)


@kernel
def apply(x, d, stretch: float, room) -> None:
    """x_m += sum_k A_k D[k, m], in place, of anomalies A that are stretched before; room: (N + 1) x BLOCK numbers.

    What all members have in common stays to the bit.
    """
    n, size = x.shape
    for first in range(0, size, BLOCK):
        width = min(BLOCK, size - first)
        for i in range(width):
            total = 0.0
            for k in range(n):
                total += x[k, first + i] - x[0, first + i]
            room[n, i] = total / n
        base, most = room[n], 0.0
        for k in range(n):
            for i in range(width):
                room[k, i] = stretch * (x[k, first + i] - x[0, first + i] - base[i])
                most = max(most, abs(room[k, i]))
        if most == 0.0:  # rings that no wave has reached, slots of what is not fitted
            continue
        more = (stretch - 1.0) / stretch
        for m in range(n):
            for k in range(0, n - n % 4, 4):  # four at a time: x is read and written once for them
                a, b, c, e = d[k, m], d[k + 1, m], d[k + 2, m], d[k + 3, m]
                for i in range(width):
                    x[m, first + i] += (a * room[k, i] + b * room[k + 1, i]) + (c * room[k + 2, i] + e * room[k + 3, i])
            for k in range(n - n % 4, n):
                for i in range(width):
                    x[m, first + i] += d[k, m] * room[k, i]
            for i in range(width):
                x[m, first + i] += more * room[m, i]
