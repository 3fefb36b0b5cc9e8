"""The variables of an FMU: what an importer sees of it, and sets."""

import math
from enum import StrEnum
from typing import NamedTuple


class Type(StrEnum):
    """Of a value."""

    REAL = "REAL"
    WHOLE = "WHOLE"
    TRUTH = "TRUTH"


class Role(StrEnum):
    """Who writes a variable, and when."""

    FIXED = "FIXED"  # parameter, set before the simulation
    TUNABLE = "TUNABLE"  # parameter, set at any communication point
    INPUT = "INPUT"
    OUTPUT = "OUTPUT"
    CONSTANT = "CONSTANT"
    TIME = "TIME"


class Variable(NamedTuple):
    """One of them; its value reference is its place among all."""

    name: str
    role: Role
    unit: str  # SI
    start: float
    words: str
    low: float = -math.inf
    high: float = math.inf
    type: Type = Type.REAL


def where(variables: list[Variable], name: str) -> int:
    """The value reference of a variable."""
    return [variable.name for variable in variables].index(name)
