"""What the further channels of the card touch, off a plant that runs.

Most are observed quantities. The accelerometer gives the mean over the last step, impacts included. The force cell is
between the rod and what it carries, the piston's own mass counted there (2.10): `F = m (g + a) - F_ext`, and what
presses the buffer of a weight that waits. So the rod's stops do not act on it, and at rest it shows the weight.
"""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit.block import MASS, Compiled
from twin.circuit.state import place_of
from twin.topology import CHANNELS, OBSERVED

Array = NDArray[np.float64]
POSITION_AT, FACE_AT, CARRIED_AT = map(place_of, ("piston.position", "weight.position", "weight.carried"))
SPEED = [*CHANNELS].index("velocity")  # of the taps


class Moment(NamedTuple):
    """The end of a block."""

    state: Array  # flat
    seen: Array  # the OBSERVED quantities
    taps: Array  # what the CHANNELS touch, a step before and now
    parts: Any  # a record of `Parts`


def acceleration(now: Moment) -> float:
    """Of the piston [m/s^2], upwards."""
    return (now.taps[1, SPEED] - now.taps[0, SPEED]) / now.parts["step"]


def force(now: Moment) -> float:
    """Of the rod on its load [N], upwards."""
    load, state = now.parts["load"], now.state
    pressed = (1.0 - state[CARRIED_AT]) * max(0.0, state[POSITION_AT] - state[FACE_AT])
    return now.seen[MASS] * (load["gravity"] + acceleration(now)) - load["force"] + load["stiffness"] * pressed


DERIVED: dict[str, Callable[[Moment], float]] = {"force": force, "acceleration": acceleration}


class Sensing:
    """Reads some of the SENSORS of a plant; the plant's record may change while it runs."""

    def __init__(self, names: Iterable[str], plant: Compiled) -> None:
        places = [*OBSERVED]
        chosen = [*enumerate(names)]
        self._parts = plant.parts
        self._values = np.zeros(len(chosen))
        self._into = [j for j, name in chosen if name in OBSERVED]
        self._from = [places.index(name) for _, name in chosen if name in OBSERVED]
        self._derived = [(j, DERIVED[name]) for j, name in chosen if name not in OBSERVED]

    def read(self, state: Array, seen: Array, taps: Array) -> Array:
        """The true values, in the order of the names; valid until the next."""
        self._values[self._into] = seen[self._from]
        now = Moment(state, seen, taps, self._parts[0])
        for j, derived in self._derived:
            self._values[j] = derived(now)
        return self._values
