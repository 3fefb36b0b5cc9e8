"""What moves in the picture of the rig, at the instants at which it is drawn."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.recording.reader import Recording
from bridge.recording.seen import seen
from controller.grid import NS
from twin.topology import HOLLOWS, LINES, PIPES, PLACES, POINTS, cavity

Array = NDArray[np.float64]
APART = NS // 50  # [ns], of the frames of a recording without profiles


class Frames(NamedTuple):
    """One row an instant; SI."""

    stamps: NDArray[np.int64]  # [ns]
    state: dict[str, Array]  # fields of the true state; NaN where a rig was measured and no sensor read it
    pressure: Array  # (n, 6, places)
    cavity: Array  # (n, 15)


def frames(recording: Recording) -> Frames:
    """The frames of a recording: where both state and profile are known."""
    state = seen(recording)
    stamps, pressure, cavity = profiles(recording)
    shared, rows, at = np.intersect1d(state["stamp"], stamps, return_indices=True)
    return Frames(shared, {name: column[rows] for name, column in state.items()}, pressure[at], cavity[at])


def profiles(recording: Recording) -> tuple[NDArray[np.int64], Array, Array]:
    """Stamps, pressures (n, 6, places) and cavities (n, 15) of the lines.

    A recording that has only states gets straight lines between the ends of each pipe.
    """
    lines = recording.messages("lines")
    if not lines:
        return _straight(seen(recording))
    stamps = np.array([line.stamp for line in lines], np.int64)
    pressure = np.array([line.pressure for line in lines]).reshape(len(lines), LINES, -1)
    return stamps, pressure, np.array([line.cavity for line in lines])


def _straight(state: dict[str, NDArray]) -> tuple[NDArray[np.int64], Array, Array]:
    drawn = {name: column[state["stamp"] % APART == 0] for name, column in state.items()}
    none, share = np.zeros(len(drawn["stamp"])), np.linspace(0.0, 1.0, POINTS)
    rows = []
    for pipe in PIPES.values():
        start, end = (drawn[PLACES[place].pressure] if place in PLACES else none for place in pipe)
        rows.append(start[:, None] * (1.0 - share) + end[:, None] * share)
    known = [drawn.get(cavity(name), none) for name in HOLLOWS]
    return drawn["stamp"], np.stack(rows, axis=1), np.stack(known, axis=1)
