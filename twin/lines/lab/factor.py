"""Factorised matrices of (p, u) for solving again and again: banded where the band is narrow, full where it is not."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.linalg import lapack as scipy_lapack

from twin.lines.lab.pipe import Array

lapack: Any = scipy_lapack  # whose annotations lack its functions
NARROW = 0.25  # of the size, width of a band


def factorise(matrix: Any) -> Callable[[Array], Array]:
    """The solution of a sparse real system as a function of the right side; p_i and u_i are put side by side.

    ValueError if the matrix is singular.
    """
    entries = matrix.tocoo()
    n = matrix.shape[0] // 2
    order = np.arange(2 * n).reshape(2, n).T.ravel()  # p_0, u_0, p_1, ..
    place = np.argsort(order)
    row, column = place[entries.row], place[entries.col]
    below, above = max(0, int((row - column).max())), max(0, int((column - row).max()))
    if below + above > NARROW * 2 * n:
        return _full(matrix.toarray())
    band = np.zeros((2 * below + above + 1, 2 * n))
    np.add.at(band, (below + above + row - column, column), entries.data)
    lu, pivots, info = lapack.dgbtrf(band, below, above)
    _check(info)

    def solve(right: Array) -> Array:
        out = np.empty_like(right)
        out[order] = lapack.dgbtrs(lu, below, above, right[order], pivots)[0]
        return out

    return solve


def _full(matrix: Array) -> Callable[[Array], Array]:
    lu, pivots, info = lapack.dgetrf(matrix)
    _check(info)
    return lambda right: lapack.dgetrs(lu, pivots, right)[0]


def _check(info: int) -> None:
    if info != 0:
        raise ValueError(f"singular matrix (row {info}): what the ends hold does not determine the line")
