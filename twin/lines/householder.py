"""Least squares by Householder reflections, in one fixed order of operations.

A fit must give the same bits in every process. LAPACK may not: its result depends on the number of threads, which a
process pinned to one core changes. Matrices are stored by columns: `columns[j]` is the j-th one.
"""

import math

import numpy as np
from numpy.typing import NDArray

from twin.kernel import allocating_kernel

Matrix = NDArray[np.float64]


@allocating_kernel
def triangulate(columns, count: int) -> None:
    """Reflect in place so that the first `count` columns become upper triangular; the others are carried along."""
    size = columns.shape[1]
    for k in range(count):
        v = columns[k, k:].copy()
        norm = 0.0
        for i in range(size - k):
            norm += v[i] * v[i]
        norm = math.sqrt(norm)
        if norm == 0.0:
            continue
        v[0] += math.copysign(norm, v[0])
        scale = 1.0 / (norm * abs(v[0]))  # 2/(v v)
        for j in range(k, columns.shape[0]):
            target = columns[j, k:]
            along = 0.0
            for i in range(size - k):
                along += v[i] * target[i]
            along *= scale
            for i in range(size - k):
                target[i] -= along * v[i]


@allocating_kernel
def back_substitute(columns, count: int):
    """x of R x = y, R the upper triangle of the first `count` columns and y the column after them."""
    x = columns[count, :count].copy()
    for k in range(count - 1, -1, -1):
        x[k] /= columns[k, k]
        for i in range(k):
            x[i] -= columns[k, i] * x[k]
    return x


def solve(matrix: Matrix, right: Matrix) -> Matrix:
    """x that makes |matrix x - right| smallest; rows may outnumber the unknowns."""
    columns = np.ascontiguousarray(np.vstack([matrix.T, right]))
    triangulate(columns, matrix.shape[1])
    return back_substitute(columns, matrix.shape[1])


def triangle(matrix: Matrix, right: Matrix) -> tuple[Matrix, Matrix]:
    """A square system with the same least squares: R and Q'right."""
    n = matrix.shape[1]
    columns = np.ascontiguousarray(np.vstack([matrix.T, right]))
    triangulate(columns, n)
    return np.triu(columns[:n, :n].T), columns[n, :n].copy()


def split(constraints: Matrix, values: Matrix) -> tuple[Matrix, Matrix]:
    """All x with constraints x = values: x = x0 + Z y, as (x0, Z), Z with orthonormal columns."""
    m, n = constraints.shape
    columns = np.ascontiguousarray(np.vstack([constraints, np.eye(n)]))
    triangulate(columns, m)
    r, q = columns[:m, :m], columns[m:]  # constraints' = Q [R; 0]: columns holds R', q[j] is the j-th row of Q
    y = np.zeros(m)
    for k in range(m):
        y[k] = (values[k] - sum(r[k, i] * y[i] for i in range(k))) / r[k, k]
    return product(q[:, :m].copy(), y.reshape(m, 1))[:, 0], np.ascontiguousarray(q[:, m:])


@allocating_kernel
def product(a, b):
    """a b, summed in the order of the inner index."""
    out = np.zeros((a.shape[0], b.shape[1]))
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            for j in range(b.shape[1]):
                out[i, j] += a[i, k] * b[k, j]
    return out
