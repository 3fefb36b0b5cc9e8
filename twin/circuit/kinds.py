"""A part of a circuit as the kind that an equation is written for: the rig may fit another."""

from typing import TypeVar

from twin.cylinder import Cylinder
from twin.load import Load
from twin.pump import Pump
from twin.relief.network import Relief
from twin.seal import Seal
from twin.spool_valve import SpoolValve

K = TypeVar("K")
CHOSEN_BY: dict[type, str] = {
    Cylinder: "actuator.kind = 'cylinder' without a wall or leaks to the outside",
    Load: "load.kind = 'mass'",
    Pump: "supply.kind = 'gear'",
    Relief: "relief.kind = 'two-stage'",
    Seal: "friction.kind = 'seal'",
    SpoolValve: "valve.kind = 'proportional'",
}


def of_kind(part: object, kind: type[K]) -> K:
    """The part, which is of this kind of CHOSEN_BY; ValueError where another is fitted."""
    if not isinstance(part, kind):
        raise ValueError(f"a {kind.__name__} is needed, and a {type(part).__name__} is fitted: take {CHOSEN_BY[kind]}")
    return part
