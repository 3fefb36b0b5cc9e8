"""Errors of numbers where what a fit leaves is not noise: a part of the rig is missing in the twin.

What is missing does not average out: other stretches of the data ask for other numbers, and more data of the same kind
do not say which are the rig's. So an interval holds what another stretch would ask for, not only the mean of all: the
predictive interval of a random-effects model (J. Higgins, S. Thompson, D. Spiegelhalter, J. R. Stat. Soc. A 172 (2009)
137). With g_k = J_k'r_k of each block of half a second, A_k = J_k'J_k and C = (J'J + P)^-1 = W W', white noise makes
the sum of W'g_k g_k'W the unit matrix. What is more than that, and more than chance, is what numbers D that differ from
block to block add, A_k D A_k in each. Blocks do not tell equally much: they count as kappa equal ones, p over the trace
of the sum of (W'A_k W)^2, so that the covariance is W (1 + kappa (excess)) W'. Without the factor kappa it would be the
sandwich of H. White (Econometrica 50 (1982) 1), the error of the mean.

What is missing all the time and everywhere alike looks like another number and leaves nothing: no interval knows of it.
"""

import math

import numpy as np

from bridge.studies.identification.data import Array
from bridge.studies.identification.fit import Fitted

BLOCK = 0.5  # [s]: longer than what rings, shorter than what moves between two places
CHANCE = 2.0  # deviations that white noise may add to a direction


def scattered(found: Fitted, plain: Array) -> Array:
    """Covariance of the places, of numbers that differ from block to block; plain: C, of white noise."""
    size, turned = np.linalg.eigh(plain)
    root = turned * np.sqrt(size)
    total, squares = np.zeros_like(plain), 0.0
    for score, information in _blocks(found, root):
        total += np.outer(score, score)
        squares += float((information * information).sum())
    kappa = len(plain) / max(squares, 1e-300)
    times, along = np.linalg.eigh(total)
    excess = np.where(times > 1.0 + CHANCE * math.sqrt(2.0 / kappa), times - 1.0, 0.0)
    return root @ (np.eye(len(plain)) + kappa * (along * excess) @ along.T) @ root.T


def _blocks(found: Fitted, root: Array):
    """W'g_k and W'A_k W of each block."""
    row = 0
    for shot, at in zip(found.task.shots, found.shots, strict=True):
        record = found.task.records[shot.record]
        shape = len(record.signals), -1
        slopes = (found.jacobian[row : row + len(at.residual)] @ root).reshape(*shape, len(root))
        residual, length = at.residual.reshape(shape), max(1, round(BLOCK / record.period))
        for begin in range(0, residual.shape[1], length):
            part = slopes[:, begin : begin + length].reshape(-1, len(root))
            yield part.T @ residual[:, begin : begin + length].ravel(), part.T @ part
        row += len(at.residual)
