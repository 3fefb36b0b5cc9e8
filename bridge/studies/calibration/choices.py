"""The numbers of the rig that the thesis does not give, and the range in which each is plausible."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.rig import rig_number

PLACE = 0.112  # [m], start of the load change
LENGTHS = {"pipe_1": 1.0, "pipe_2": 2.5, "pipe_3": 2.0, "pipe_4": 2.0, "pipe_5": 2.0, "pipe_6": 1.5}  # [m]


class Choice(NamedTuple):
    """A number to choose."""

    name: str  # part.name
    prior: float  # the value taken where no fact says otherwise, SI
    low: float
    high: float
    reason: str  # of the range
    logarithmic: bool = False


CHOICES = (
    Choice("seal.diameter", 82e-3, 32e-3, 82e-3, "rod seal alone .. a seal each on piston and rod"),
    Choice("seal.downward", 1.0, 0.7, 1.4, "2.3: not the same up and down; assumed range"),
    Choice("cylinder.leakage_resistance", 1.04e12, 1.04e12, 1.04e13, "Table 2.1, exponent 7 or 8 in bar s/m^3", True),
    Choice("switching_valve.switching_time", 30e-3, 20e-3, 90e-3, "assumed range; DC magnets: 45 to 60 ms"),
    Choice("switching_valve.return_time", 30e-3, 15e-3, 60e-3, "assumed range; by springs: 20 to 30 ms"),
    Choice("switching_valve.cylinder_opens", 0.0, 0.0, 0.6, "assumed range: lands of a spool overlap"),
    Choice("switching_valve.idle_shuts", 1.0, 0.4, 1.0, "assumed range: lands of a spool overlap"),
    Choice("switching_valve.rated_drop", 5e5, 2e5, 8e5, "assumed range at 60 l/min, by spool"),
    Choice("pipe_3.wall", 5e-3, 3e-3, 8e-3, "assumed range; hoses of 11 mm: 17 to 27 mm outside"),
    *(
        Choice(f"{pipe}.length", prior, 0.5, 4.0, "assumed range: a rig that stands in one room")
        for pipe, prior in LENGTHS.items()
    ),
    Choice("pump.efficiency_pressure", 35e5, 20e5, 55e5, "assumed range: pressures while the piston rises"),
    Choice("start.position", 0.1, 0.09, 0.13, "assumed range, below the 138 mm of the contact"),
    Choice("relief.nozzle_diameter", 0.8e-3, 0.5e-3, 0.9e-3, "assumed range; the others have 0.6 mm"),
)  # fmt: skip
HOSES = ("pipe_3", "pipe_4", "pipe_6")  # have one wall


def scaled(choice: Choice, value: float) -> float:
    """Where a value stands in its range, 0 .. 1."""
    low, high = choice.low, choice.high
    if choice.logarithmic:
        return math.log(value / low) / math.log(high / low)
    return (value - low) / (high - low)


def value_at(choice: Choice, share: float) -> float:
    """The value at a place in the range."""
    if choice.logarithmic:
        return choice.low * (choice.high / choice.low) ** share
    return choice.low + share * (choice.high - choice.low)


def priors() -> NDArray[np.float64]:
    """Where the values stand that are taken without a fact."""
    return np.array([scaled(choice, choice.prior) for choice in CHOICES])


def chosen(shares: NDArray[np.float64]) -> dict[str, float]:
    """The values at places in the ranges, by name."""
    return {choice.name: value_at(choice, float(s)) for choice, s in zip(CHOICES, shares, strict=True)}


def of_the_rig() -> dict[str, float]:
    """The values that stand in the rig now."""
    return {choice.name: _in_the_rig(*choice.name.split(".")) for choice in CHOICES}


def _in_the_rig(part: str, name: str) -> float:
    return PLACE if part == "start" else rig_number(part, name)


def overrides(values: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """Values as parts of the rig; all hoses get one wall."""
    parts: dict[str, dict[str, float]] = {}
    for name, value in values.items():
        part, _, entry = name.partition(".")
        for each in HOSES if name == "pipe_3.wall" else (part,):
            parts.setdefault(each, {})[entry] = value
    return parts
