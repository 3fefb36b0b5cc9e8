"""The part of a plant that its input moves and its position and velocity show, as far as rests go.

A rig without a leak has rests that its valve cannot choose among: oil shut into both chambers at once presses as
hard whatever the piston does. Such an eigenvalue 0 stays a multiplier 1 in every loop and says nothing about it. Only
these are taken out; an unmoved mode that decays is harmless, and one that grows is an instability.
"""

from typing import Any

import numpy as np
from scipy.linalg import block_diag, matrix_balance, schur, solve_sylvester

from controller.stability.plant import Array, Plant

ZERO = 1e-12  # of the largest entry of the balanced matrix: eigenvalues below it are 0 up to rounding
SHARE = 1e-8  # of the strongest: what the input moves by less, it does not move


def movable(plant: Plant) -> Plant:
    """The same plant without the eigenvalues 0 that its input does not move or no output shows; fewer states then.

    One plant, no stack. Returned as it is where there is nothing to take out.
    """
    balanced, scale = matrix_balance(plant.a, permute=False)
    scales = np.diag(scale)
    outputs = np.stack([row for row in (plant.position, plant.velocity) if row is not None]) * scales
    small = ZERO * np.abs(balanced).max()
    parts: Any = schur(balanced, sort=lambda re, im=0.0: abs(complex(re, im)) < small)
    flow, base, m = parts
    rest, far, still = base[:, :m], base[:, m:], np.where(np.abs(flow[:m, :m]) < small, 0.0, flow[:m, :m])
    apart = solve_sylvester(flow[:m, :m], -flow[m:, m:], flow[:m, m:])
    inner = (rest + far @ apart.T).T  # left invariant, as rest is right
    kept = _moved_and_shown(still, inner @ (plant.b / scales), outputs @ rest)
    if kept.shape[1] == m:
        return plant
    a = np.asarray(block_diag(kept.T @ still @ kept, flow[m:, m:]), float)
    b = np.concatenate([kept.T @ inner, far.T]) @ (plant.b / scales)
    rows = outputs @ np.hstack([rest @ kept, far - rest @ apart])
    return Plant(a, b, rows[0], None if plant.velocity is None else rows[1])


def _moved_and_shown(a: Array, b: Array, outputs: Array) -> Array:
    """Orthonormal columns that span what b moves, less what no output shows."""
    moved = _span(_chain(a, b[:, None]))
    return moved @ _span(_chain((moved.T @ a @ moved).T, (outputs @ moved).T))


def _chain(a: Array, start: Array) -> Array:
    """Columns start, a start, a^2 start ..., each of length 1 or 0."""
    links = [start]
    for _ in range(len(a) - 1):
        links.append(a @ links[-1])
    columns = np.hstack(links)
    sizes = np.linalg.norm(columns, axis=0)
    return columns / np.where(sizes > SHARE * sizes.max(initial=0.0), sizes, np.inf)


def _span(columns: Array) -> Array:
    left, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return left[:, sizes > SHARE]
