"""Deviates for an ensemble: of a seed and a number alone, and exactly what they are meant to be, not only on average.

Columns over the members have mean 0, variance 1, and no correlation with one another, nor with columns that are there.
"""

import math

import numpy as np
from numpy.typing import NDArray

from twin.kernel import kernel

Array = NDArray[np.float64]
AHEAD = 64  # counts that are drawn together
DEPENDENT = 1e-9  # share of a column that is left when it depends on those before it


class Draws:
    """Normal deviates, a row for each column of an ensemble, not yet made exact."""

    def __init__(self, seed: int, rows: int, members: int) -> None:
        self._seed, self._shape = seed, (AHEAD, rows, members)
        self._number, self._block = -1, np.zeros(0)

    def at(self, count: int) -> Array:
        """Those of a count, from 0: a function of the seed, the count and the shape alone."""
        number, place = divmod(count, AHEAD)
        if number != self._number:
            source = np.random.Generator(np.random.Philox(key=self._seed, counter=[0, 0, 3, number]))
            self._number, self._block = number, source.standard_normal(self._shape)
        return self._block[place].copy()


@kernel
def exact(there, drawn) -> None:
    """Make the rows of `drawn` exact, in place; there: rows that they are to be independent of, which are lost."""
    known, n = len(there), drawn.shape[1]
    for i in range(known + len(drawn)):
        row = there[i] if i < known else drawn[i - known]
        before = 0.0
        for m in range(n):
            before += row[m] * row[m]
        total = 0.0
        for m in range(n):
            total += row[m]
        for m in range(n):
            row[m] -= total / n
        for j in range(i):
            other = there[j] if j < known else drawn[j - known]
            along = 0.0
            for m in range(n):
                along += row[m] * other[m]
            for m in range(n):
                row[m] -= along / (n - 1) * other[m]
        after = 0.0
        for m in range(n):
            after += row[m] * row[m]
        scale = math.sqrt((n - 1) / after) if after > DEPENDENT * before else 0.0
        for m in range(n):
            row[m] *= scale
