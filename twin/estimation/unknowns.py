"""What a twin beside a rig does not know: slowly wandering numbers, each a further state of the estimate.

A factor f = exp(z) on numbers of the circuit, which stays positive whatever z is, or an offset in SI; z is Gaussian, a
random walk: its deviation at the start, and its drift per square root of a second. Both are assumed. They are the
model's only errors that are stated: what else is wrong with the model is put down to them.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit.block import record
from twin.circuit.step import Parts
from twin.estimation.quantities import LOAD_FORCE, OFFSETS, UNKNOWNS, VALVE_OFFSET
from twin.topology import CHANNELS

Array = NDArray[np.float64]
ADDED = (LOAD_FORCE, VALVE_OFFSET, *OFFSETS)  # whatever the numbers of the circuit are


class Prior(NamedTuple):
    """What is assumed of one of UNKNOWNS: deviation at the start and drift per sqrt(s), of z, in its measure."""

    deviation: float
    drift: float


def weight_of(parts: Parts) -> float:
    """What the load weighs [N]; where its mass is not one number, or floats, that of 1 % of 100 bar on the piston."""
    mass, gravity = getattr(parts.load, "mass", 0.0), getattr(parts.load, "gravity", 0.0)
    return max(mass * gravity, 1e5 * getattr(parts.cylinder, "area_lower", 1e-3))


def priors(parts: Parts, given: Mapping[str, Prior] | None = None) -> dict[str, Prior]:
    """Of z, of the unknowns that a circuit has, those that are not certain; given: others than the table's."""
    found = {}
    for name, unknown in UNKNOWNS.items():
        deviation, drift = (given or {}).get(name, Prior(unknown.deviation, unknown.drift))
        there = name in ADDED or any(value_of(parts, field) for field in unknown.fields)
        if there and max(deviation, drift) > 0.0:
            scale = weight_of(parts) if name == LOAD_FORCE else 1.0
            found[name] = Prior(scale * deviation, scale * drift)
    return found


def value_of(parts: Any, path: str) -> float:
    """A number of the parts by its path; 0.0 where the kind that is fitted has none of this name."""
    for name in path.split("."):
        parts = getattr(parts, name, None)
        if parts is None:
            return 0.0
    return float(parts)


class Unknowns:
    """The parts of many circuits that differ in their unknowns only, as one array of records for the kernels."""

    def __init__(self, parts: Parts, names: Iterable[str], members: int) -> None:
        self.names = tuple(names)
        self.records = np.repeat(record(parts), members)
        self.offsets = np.zeros((members, len(CHANNELS)))  # of the transducers
        self.spool_offsets = np.zeros(members)
        self._written = [*self._places(parts)]

    def _places(self, parts: Parts) -> Iterator[tuple[int, NDArray[Any], float]]:
        """Which unknown, the array to write and its nominal value."""
        for place, name in enumerate(self.names):
            for path in UNKNOWNS[name].fields:
                nominal = value_of(parts, path)
                if nominal or (name == LOAD_FORCE and _has(parts, path)):
                    yield place, _column(self.records, path), nominal

    def write(self, z: Array) -> None:
        """Give each circuit its numbers; z: a row for each, in the order of the names."""
        values = self.values(z)
        for place, column, nominal in self._written:
            column[:] = nominal + values[:, place] if UNKNOWNS[self.names[place]].unit else nominal * values[:, place]
        for place, name in enumerate(self.names):
            if name in OFFSETS:
                self.offsets[:, OFFSETS.index(name)] = values[:, place]
            elif name == VALVE_OFFSET:
                self.spool_offsets[:] = values[:, place]

    def values(self, z: Array) -> Array:
        """Factors, and offsets in SI."""
        values = z.copy()
        factors = [not UNKNOWNS[name].unit for name in self.names]
        values[:, factors] = np.exp(z[:, factors])
        return values


def _has(parts: Any, path: str) -> bool:
    first, _, last = path.rpartition(".")
    return hasattr(getattr(parts, first), last)


def _column(records: NDArray[Any], path: str) -> NDArray[Any]:
    for name in path.split("."):
        records = records[name]
    return records
