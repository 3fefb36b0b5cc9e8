"""What a number, a choice and a table of the rig are: a value with its unit, source and limits."""

import math
from typing import NamedTuple

TINY = 1e-12  # smallest value of what must not be zero


class Number(NamedTuple):
    """One number of the rig."""

    value: float
    unit: str  # SI, "" for a pure number
    source: str
    low: float = 0.0  # smallest allowed value
    high: float = math.inf  # largest allowed value


class Choice(NamedTuple):
    """One of several words."""

    value: str
    options: tuple[str, ...]
    source: str


class Table(NamedTuple):
    """A curve by its points."""

    value: tuple[tuple[float, float], ...]
    units: tuple[str, str]  # SI, of both columns
    source: str


Entry = Number | Choice | Table
