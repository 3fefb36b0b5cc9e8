"""What moves in the picture of the rig, at the instants at which it is drawn."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.recording.reader import Recording
from controller.grid import NS
from twin.topology import HOLLOWS, PLACES

Array = NDArray[np.float64]
APART = NS // 50  # [ns], of the frames of a recording without profiles
ENDS = (  # of the six lines in the true state; the tank is at 0
    ("p_pump", "p1"),
    ("p1", "p_p"),
    ("p_a", "p_lower"),
    ("p_b", "p_upper"),
    ("p_t", "p_return"),
    ("p_return", None),
)


class Frames(NamedTuple):
    """One row an instant; SI."""

    stamps: NDArray[np.int64]  # [ns]
    state: dict[str, Array]  # fields of the true state
    pressure: Array  # (n, 6, places)
    cavity: Array  # (n, 15)


def frames(recording: Recording) -> Frames:
    """The frames of a recording: where both state and profile are known."""
    state = recording.columns("state")
    stamps, pressure, cavity = profiles(recording)
    shared, rows, at = np.intersect1d(state["stamp"], stamps, return_indices=True)
    return Frames(shared, {name: column[rows] for name, column in state.items()}, pressure[at], cavity[at])


def profiles(recording: Recording) -> tuple[NDArray[np.int64], Array, Array]:
    """Stamps, pressures (n, 6, places) and cavities (n, 15) of the lines.

    A recording that has only states gets straight lines between the ends of each pipe.
    """
    lines = recording.messages("lines")
    if not lines:
        return _straight(recording.columns("state"))
    stamps = np.array([line.stamp for line in lines], np.int64)
    pressure = np.array([line.pressure for line in lines]).reshape(len(lines), 6, -1)
    return stamps, pressure, np.array([line.cavity for line in lines])


def _straight(state: dict[str, NDArray]) -> tuple[NDArray[np.int64], Array, Array]:
    drawn = {name: column[state["stamp"] % APART == 0] for name, column in state.items()}
    none, share = np.zeros(len(drawn["stamp"])), np.linspace(0.0, 1.0, PLACES)
    rows = []
    for first, second in ENDS:
        start, end = drawn[first], none if second is None else drawn[second]
        rows.append(start[:, None] * (1.0 - share) + end[:, None] * share)
    known = [drawn.get(f"cavity_{name}", none) for name in HOLLOWS]
    return drawn["stamp"], np.stack(rows, axis=1), np.stack(known, axis=1)
