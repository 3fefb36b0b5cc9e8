"""What the further channels of the card touch, off a plant that runs.

Most are observed quantities, or numbers that a kind keeps in its slot. The accelerometer gives the mean over the last
step, impacts included. The force cell is between the rod and what it carries, the piston's own mass counted there
(2.10): `F = m (g + a) - F_ext`, and what springs, dampers, a link or the buffer of a weight that waits take. So the
rod's stops do not act on it, and at rest it shows the weight.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from twin.circuit.block import Compiled
from twin.circuit.state import SLOT_AT, place_of
from twin.compliant import STRETCH
from twin.environment import Environment
from twin.kept import FOLLOWS, kept
from twin.kernel import interpreted, kernel
from twin.load import Weight
from twin.load_slot import AnyLoad, rod_force
from twin.table import Curve
from twin.topology import CHANNELS, OBSERVED, SLOT, SLOTS

Array = NDArray[np.float64]
Places = NDArray[np.intp]
Values = Mapping[str, Mapping[str, Any]]
PLACES_SEEN = {name: place for place, name in enumerate(OBSERVED)}
SPEED = [*CHANNELS].index("velocity")  # of the taps


def place_kept(slot: str, number: int) -> int:
    """Where a kind's number stands in a flat state."""
    return SLOT_AT[SLOTS.index(slot)] + number


POSITION_AT, LOAD_AT = place_of("piston.position"), place_kept("load", 0)
WEIGHT_AT = np.array([place_of(f"weight.{name}") for name in Weight._fields])


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
    """Of the rod on its load [N], in the positive direction."""
    record = now.parts["load"]
    load, weight = as_load(record.dtype, record.item()), Weight(*now.state[WEIGHT_AT].tolist())
    place, memory = now.state[POSITION_AT], now.state[LOAD_AT : LOAD_AT + SLOT]
    return interpreted(rod_force)(load, place, now.taps[1, SPEED], acceleration(now), weight, memory)


@kernel
def rod(parts, state, taps, out) -> None:
    """`force` as native code gives it, into out[0]; parts: a record of `Parts`."""
    c = parts[0]
    speed = taps[1, SPEED]
    weight = Weight(state[WEIGHT_AT[0]], state[WEIGHT_AT[1]], state[WEIGHT_AT[2]])
    gained = (speed - taps[0, SPEED]) / c.step
    out[0] = rod_force(c.load, state[POSITION_AT], speed, gained, weight, state[LOAD_AT : LOAD_AT + SLOT])


def far_position(now: Moment) -> float:
    """Of the load behind its link [m]."""
    return now.state[POSITION_AT] + now.state[LOAD_AT + STRETCH]


KINDS: dict[tuple[str, ...], Any] = {kind._fields: kind for kind in (*get_args(AnyLoad), Environment, Curve)}


def as_load(kind: Any, numbers: tuple[Any, ...]) -> Any:
    """A load as its own type again, of a record's type and its numbers."""
    entries = zip(kind.names, numbers, strict=True)
    return KINDS[kind.names](*(as_load(kind[name], e) if isinstance(e, tuple) else e for name, e in entries))


DERIVED: dict[str, Callable[[Moment], float]] = {
    "force": force,
    "acceleration": acceleration,
    "load_position": far_position,
}


class Sensing:
    """Reads what some sensors touch of a plant, whose record may change while it runs."""

    def __init__(self, names: Iterable[str], plant: Compiled, values: Values) -> None:
        """values: the numbers of the rig, which say what is fitted."""
        chosen, own = [*enumerate(names)], kept(values)
        held = {name: place_kept(slot, entry.number) for name, (slot, entry) in own.items() if entry.number != FOLLOWS}
        self._parts = plant.parts
        self._values = np.zeros(len(chosen))
        self._seen = _pairs((j, PLACES_SEEN.get(name)) for j, name in chosen)
        self._held = _pairs((j, held.get(name)) for j, name in chosen)
        self._derived = [(j, DERIVED[name]) for j, name in chosen if name in DERIVED]

    def read(self, state: Array, seen: Array, taps: Array) -> Array:
        """The true values, in the order of the names; valid until the next."""
        for source, (into, places) in ((seen, self._seen), (state, self._held)):
            if len(into):
                self._values[into] = source[places]
        now = Moment(state, seen, taps, self._parts[0])
        for j, derived in self._derived:
            self._values[j] = derived(now)
        return self._values


def _pairs(found: Iterable[tuple[int, int | None]]) -> tuple[Places, Places]:
    """Where what has a place goes, and its places."""
    there = [(into, place) for into, place in found if place is not None]
    into, places = np.array(there, np.intp).reshape(-1, 2).T
    return into, places
