"""Switching valve 4/3 with tandem centre: at rest P runs to T and the cylinder is shut in.

2.2.1, the valve of the thesis's load-change and impingement tests. Switched, the spool travels at constant speed, by
its magnet outwards and by its springs back. The lands to the cylinder open from one share of the travel on, the land
P-T is shut from another on, each in proportion to the travel (assumed): where they overlap the pump meets the cylinder
while it still runs to the tank, and where neither is open it has the relief valve alone.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined
from twin.lands import Lands
from twin.orifice import Orifice


class SwitchingValve(NamedTuple):
    """Spool position s: 1 connects P-A and B-T (the piston lifts), -1 P-B and A-T, 0 P-T."""

    speed: float  # of the spool, away from the middle [travel/s]
    return_speed: float  # back to it [travel/s]
    opens: float  # share of the travel from which the lands to the cylinder open
    shuts: float  # share of the travel from which P-T is shut
    area: float  # of one fully open land [m^2]
    orifice: Orifice


@inlined
def switch_spool(position: float, reference: float, valve: SwitchingValve, step: float) -> tuple[float, float]:
    """Spool position and speed a step later; the magnets know three positions: a reference beyond +-1/2 switches."""
    target = math.copysign(1.0, reference) if abs(reference) > 0.5 else 0.0
    way = target - position
    speed = valve.return_speed if way * position < 0.0 else valve.speed
    if abs(way) <= speed * step * (1.0 + 1e-9):
        return target, 0.0
    speed = math.copysign(speed, way)
    return position + speed * step, speed


@inlined
def tandem_lands(spool: float, valve: SwitchingValve) -> Lands:
    """Areas [m^2] at a spool position."""
    way = 1.0 - valve.opens
    up, down = valve.area * max(0.0, spool - valve.opens) / way, valve.area * max(0.0, -spool - valve.opens) / way
    return Lands(up, up, down, down, valve.area * max(0.0, 1.0 - abs(spool) / valve.shuts))
