"""Derivatives in x: M f_x ~ D f on a grid, and what integrates over it.

    cds3       three points, summation by parts (2, 1)
    cds5       five points, summation by parts (4, 2) after Strand 1994; other closures to show what they do
    fem        linear finite elements, consistent mass
    chebyshev  collocation at x = L (1 - cos(pi j/N))/2, after Trefethen 2000

Summation by parts: M = H > 0 symmetric and D + D^T = diag(-1, 0, .., 0, 1). With it the semi-discrete energy
p^T H p + u^T H u changes by what crosses the ends alone, also where an end's value is injected, since the equation left
out there is multiplied by the value held. Chebyshev lacks it.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy import sparse

from twin.lines.lab.pipe import Array

Sparse = Any  # scipy.sparse.csr_array, whose annotations are not there
SPACES = ("cds3", "cds5", "fem", "chebyshev")
CLOSURES = ("sbp", "one-sided 5", "one-sided 4")
SBP_NORM = (17.0 / 48.0, 59.0 / 48.0, 43.0 / 48.0, 49.0 / 48.0)
SBP_ROWS = (
    (-24.0 / 17.0, 59.0 / 34.0, -4.0 / 17.0, -3.0 / 34.0, 0.0, 0.0),
    (-0.5, 0.0, 0.5, 0.0, 0.0, 0.0),
    (4.0 / 43.0, -59.0 / 86.0, 0.0, 59.0 / 86.0, -4.0 / 43.0, 0.0),
    (3.0 / 98.0, 0.0, -59.0 / 98.0, 0.0, 32.0 / 49.0, -4.0 / 49.0),
)
ONE_SIDED_5 = ((-25.0 / 12.0, 4.0, -3.0, 4.0 / 3.0, -0.25), (-0.25, -5.0 / 6.0, 1.5, -0.5, 1.0 / 12.0))
ONE_SIDED_4 = ((-11.0 / 6.0, 3.0, -1.5, 1.0 / 3.0), (-1.0 / 3.0, -0.5, 1.0, -1.0 / 6.0))
CENTRAL_5 = (1.0 / 12.0, -2.0 / 3.0, 0.0, 2.0 / 3.0, -1.0 / 12.0)
FEWEST = {"cds3": 2, "cds5": 8, "fem": 2, "chebyshev": 3}


_diagonals: Any = sparse.diags_array  # whose annotations take one offset only


class Grid(NamedTuple):
    """Places and operators. `mass` and `derivative` carry the same factor, so that collocation has mass 1."""

    x: Array  # (n,) [m]
    mass: Sparse  # M (n, n)
    derivative: Sparse  # D (n, n), M f_x ~ D f [M/m]
    norm: Sparse  # H (n, n) [m]: f^T H g ~ int f g dx


def grid(space: str, cells: int, length: float, closure: str = "sbp") -> Grid:
    """A grid between two ends. ValueError: unknown space or closure, too few cells."""
    if space not in SPACES or closure not in CLOSURES:
        raise ValueError(f"space {space!r}, closure {closure!r}; known: {', '.join(SPACES)}; {', '.join(CLOSURES)}")
    if cells < FEWEST[space]:
        raise ValueError(f"{cells} cells are too few for {space}; take {FEWEST[space]} or more")
    if space == "chebyshev":
        return _chebyshev(cells, length)
    h = length / cells
    x = h * np.arange(cells + 1)
    if space == "fem":
        mass = _diagonals([1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0], offsets=[-1, 0, 1], shape=(cells + 1,) * 2).tolil()
        mass[0, 0] = mass[cells, cells] = 1.0 / 3.0
        return Grid(x, mass.tocsr(), _central_3(cells, 0.5) / h, mass.tocsr() * h)
    if space == "cds3":
        diagonal = np.ones(cells + 1)
        diagonal[[0, -1]] = 0.5
        norm = _diagonals(diagonal)
        rows = _diagonals(1.0 / diagonal) @ _central_3(cells, 0.5) / h
        return Grid(x, sparse.eye_array(cells + 1).tocsr(), rows.tocsr(), norm.tocsr() * h)
    return _central_5(x, closure)


def _central_3(cells: int, edge: float) -> Sparse:
    """int phi_i phi_j' of hats; between the ends h f_x by three points."""
    rows = _diagonals([-0.5, 0.5], offsets=[-1, 1], shape=(cells + 1,) * 2).tolil()
    rows[0, 0], rows[cells, cells] = -edge, edge
    return rows.tocsr()


def _central_5(x: Array, closure: str) -> Grid:
    n, h = len(x), x[1] - x[0]
    rows = _diagonals(CENTRAL_5, offsets=[-2, -1, 0, 1, 2], shape=(n, n)).tolil()
    special = {"sbp": SBP_ROWS, "one-sided 5": ONE_SIDED_5, "one-sided 4": ONE_SIDED_4}[closure]
    for i, row in enumerate(special):
        rows[i, :], rows[n - 1 - i, :] = 0.0, 0.0
        for j, value in enumerate(row):
            rows[i, j], rows[n - 1 - i, n - 1 - j] = value, -value
    diagonal = np.ones(n)
    diagonal[:4], diagonal[-4:] = SBP_NORM, SBP_NORM[::-1]
    return Grid(x, sparse.eye_array(n).tocsr(), rows.tocsr() / h, _diagonals(diagonal * h).tocsr())


def _chebyshev(cells: int, length: float) -> Grid:
    """Trefethen's matrix; the norm by Clenshaw and Curtis, on the diagonal."""
    angle = np.pi * np.arange(cells + 1) / cells
    y, c = -np.cos(angle), np.ones(cells + 1)
    c[[0, -1]] = 2.0
    c *= (-1.0) ** np.arange(cells + 1)
    apart = 2.0 * np.sin(np.add.outer(angle, angle) / 2.0) * np.sin(np.subtract.outer(angle, angle) / 2.0)
    with np.errstate(divide="ignore"):
        d = np.outer(c, 1.0 / c) / (apart + np.eye(cells + 1))
    d -= np.diag(d.sum(axis=1))
    mode = np.arange(0, cells + 1, 2)
    share = np.where((mode == 0) | (mode == cells), 0.5, 1.0)
    norm = (np.cos(np.outer(angle, mode)) * (share * 2.0 / (1.0 - mode**2))).sum(axis=1) * 2.0 / cells
    norm[[0, -1]] *= 0.5
    x = length / 2.0 * (1.0 + y)
    return Grid(
        x, sparse.eye_array(cells + 1).tocsr(), sparse.csr_array(d * 2.0 / length),
        _diagonals(norm * length / 2.0).tocsr(),
    )  # fmt: skip


def periodic_grid(space: str, cells: int, length: float) -> Grid:
    """The interior scheme on a ring of a length [m], without ends; not for Chebyshev."""
    if space not in ("cds3", "cds5", "fem"):
        raise ValueError(f"space {space!r} has no ring; known: cds3, cds5, fem")
    h = length / cells
    star = CENTRAL_5 if space == "cds5" else (0.0, -0.5, 0.0, 0.5, 0.0)
    one = sparse.eye_array(cells).tocsr()
    mass = _ring(cells, (0.0, 1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0, 0.0)) if space == "fem" else one
    return Grid(h * np.arange(cells), mass, _ring(cells, star) / h, mass * h)


def _ring(cells: int, star: tuple[float, ...]) -> Sparse:
    i = np.arange(cells)
    rows, columns = np.tile(i, 5), np.concatenate([(i + k - 2) % cells for k in range(5)])
    return sparse.csr_array((np.repeat(star, cells), (rows, columns)), shape=(cells, cells))


def relative_speed(space: str, angle: Array) -> Array:
    """Speed of a wave on the grid over a, by its angle per cell 2 pi h/wave length: semi-discrete dispersion, exact."""
    if space == "cds3":
        return np.sin(angle) / angle
    if space == "cds5":
        return (8.0 * np.sin(angle) - np.sin(2.0 * angle)) / (6.0 * angle)
    if space == "fem":
        return 3.0 * np.sin(angle) / ((2.0 + np.cos(angle)) * angle)
    raise ValueError(f"space {space!r} is not uniform; known: cds3, cds5, fem")
