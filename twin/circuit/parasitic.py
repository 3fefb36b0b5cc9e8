"""Inertance that the scheme puts between the ends of a line without inertia, and what swings on it.

A `volume` or a manifold has L = 2 (1 + e) h^2/C between its ends (`twin/lines/volume.py`). With a greater capacity C_n
beside it, a chamber or another volume, that swings at 1/(2 pi sqrt(L C_n)): the slower, the smaller the volume is.
"""

import math
from typing import NamedTuple

from twin.actuator import moduli, volumes
from twin.circuit.limits import natural_frequency
from twin.circuit.step import Circuit
from twin.kernel import interpreted
from twin.lines.volume import CALM
from twin.topology import CHAMBERS, ENDS, LINES, PIPES

CLEAR = 5.0  # times the load's frequency: from there on it changes that by less than 1/25


class Parasitic(NamedTuple):
    """A line whose inertance comes near the load's own motion."""

    line: str
    capacity: float  # its own [m^3/Pa]
    beside: float  # the greater one of what is at its two ends [m^3/Pa]
    frequency: float  # of the swing [Hz]
    load: float  # natural frequency of the load on its oil, in mid-stroke [Hz]
    step: float  # at which the swing would be clear of that [s]


def parasitic(circuit: Circuit) -> list[Parasitic]:
    """The lines without inertia whose numerical inertance matters, at the circuit's step."""
    step, found = circuit.parts.step, []
    load = natural_frequency(circuit, 0.5 * circuit.parts.cylinder.stroke) / (2.0 * math.pi)
    for number, line in enumerate(PIPES):
        if circuit.lines.travel_time[number] > 0.0:
            continue
        own, beside = float(circuit.lines.capacity[number]), _beside(circuit, number)
        if beside <= own:
            continue
        inertance = 2.0 * (1.0 + CALM) * step**2 / own
        frequency = 1.0 / (2.0 * math.pi * math.sqrt(inertance * beside))
        if frequency < CLEAR * load:
            found.append(Parasitic(line, own, beside, frequency, load, step * frequency / (CLEAR * load)))
    return found


def _beside(circuit: Circuit, number: int) -> float:
    """The greater capacity [m^3/Pa] of what is joined to either end of a line."""
    cylinder = circuit.parts.cylinder
    volume, modulus = interpreted(volumes)(cylinder, 0.5 * cylinder.stroke), interpreted(moduli)(cylinder)
    chamber = [v / b for v, b in zip(volume, modulus, strict=True)]

    def at(place: str) -> float:
        others = (i for i in range(LINES) if i != number and place in ENDS[2 * i : 2 * i + 2])
        volumes_there = (float(circuit.lines.capacity[i]) for i in others if circuit.lines.travel_time[i] == 0.0)
        return sum(volumes_there) + (chamber[CHAMBERS.index(place)] if place in CHAMBERS else 0.0)

    return max(map(at, ENDS[2 * number : 2 * number + 2]))
