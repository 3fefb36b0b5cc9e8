"""Where pipes run: a way of a given length between two points, along the axes, with rounded corners.

The way leaves its start along one axis, makes a detour that is as long as it must be, and comes in from there. So a
pipe of the rig stands in the picture as long as it is.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

BEND = 0.05  # [m], radius of a corner
ARC = 6  # pieces of a corner
LOST = 2.0 - math.pi / 2.0  # what a corner saves, in radii
Points = NDArray[np.float64]  # (n, 3), [m]


def route(start: Points, end: Points, length: float, detour: Points) -> Points:
    """A way from start to end of a length [m], by a detour along a unit vector; straight if none is so short."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    reach = float((end - start) @ detour)
    across = end - start - reach * detour
    gap = float(np.linalg.norm(across))
    out = 0.5 * (length + 2.0 * LOST * BEND - gap - abs(reach))
    if out < BEND or gap < 2.0 * BEND:
        return np.array([start, end])
    turn = (max(0.0, reach) + out) * detour
    return rounded(np.array([start, start + turn, start + across + turn, end]))


def rounded(corners: Points) -> Points:
    """The corners of a way replaced by arcs."""
    points = [corners[0]]
    for before, corner, after in zip(corners, corners[1:], corners[2:], strict=False):
        inward, outward = _unit(before - corner), _unit(after - corner)
        centre = corner + BEND * (inward + outward)
        for angle in np.linspace(0.0, math.pi / 2.0, ARC + 1):
            points.append(centre - BEND * (math.cos(angle) * outward + math.sin(angle) * inward))
    return np.array([*points, corners[-1]])


def _unit(vector: Points) -> Points:
    return vector / np.linalg.norm(vector)


def length_of(way: Points) -> float:
    """Its length [m]."""
    return float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())


def segments(way: Points, count: int) -> list[Points]:
    """The way cut into equally long pieces, corners kept."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))])
    cuts = np.linspace(0.0, along[-1], count + 1)
    pieces = []
    for begin, end in pairwise(cuts):
        inside = along[(along > begin + 1e-9) & (along < end - 1e-9)]
        at = np.concatenate([[begin], inside, [end]])
        pieces.append(np.stack([np.interp(at, along, way[:, axis]) for axis in range(3)], axis=1))
    return pieces
