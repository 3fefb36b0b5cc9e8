"""Parts of a run by what its reference does: constant stretches, the steps between them, and motion."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.floating]

LEAST_SAMPLES = 10  # of a constant stretch


class Stretch(NamedTuple):
    """Samples start..stop-1, all of one reference value."""

    start: int
    stop: int
    steps: bool  # begins with a jump from another constant value

    @property
    def samples(self) -> slice:
        """Its part of every signal."""
        return slice(self.start, self.stop)


def constant_stretches(reference: Array) -> list[Stretch]:
    """Stretches of at least 10 equal samples; the run's first may be shorter and still be stepped from."""
    changes = np.flatnonzero(np.diff(reference)) + 1
    edges = np.concatenate(([0], changes, [reference.size]))
    held = np.diff(edges) >= LEAST_SAMPLES
    before = np.concatenate(([False], held[:-1]))
    before[1:2] = True
    return [Stretch(int(edges[k]), int(edges[k + 1]), bool(before[k])) for k in np.flatnonzero(held)]


def held_stretches(reference: Array, moved: bool = False) -> list[Stretch]:
    """Constant stretches in which the loop must hold what it has reached: those that follow a motion of the reference.

    The stretch before the first motion says nothing, unless the reference never moves. `moved`: it did so before these
    samples. None for a law that follows no reference (NaN).
    """
    found = [stretch for stretch in constant_stretches(reference) if not np.isnan(reference[stretch.start])]
    waits = found and found[0].start == 0 and found[0].stop < reference.size and not moved
    return found[1:] if waits else found


def moving(reference: Array) -> npt.NDArray[np.bool_]:
    """Samples between which the reference moves by less than a jump: ramps, waves, trajectories."""
    changes = np.abs(np.diff(reference))
    changing = np.concatenate(([False], changes > 0.0))
    return changing & (np.roll(changing, 1) | np.roll(changing, -1))
