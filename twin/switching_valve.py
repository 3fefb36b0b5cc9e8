"""Switching valve 4/3 with tandem centre: at rest P runs to T and the cylinder is shut in.

2.2.1, the valve of the source's load-change and impingement tests. Switched, the spool travels at constant speed; on
its way the land P-T closes as those to the cylinder open, in proportion to the travel (assumed), so that for the
switching time the pump meets the cylinder while it still runs to the tank.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined
from twin.lands import Lands
from twin.orifice import Orifice


class SwitchingValve(NamedTuple):
    """Spool position s: 1 connects P-A and B-T (the piston lifts), -1 P-B and A-T, 0 P-T."""

    speed: float  # of the spool [travel/s]
    area: float  # of one fully open land [m^2]
    orifice: Orifice


@inlined
def switch_spool(position: float, reference: float, valve: SwitchingValve, step: float) -> tuple[float, float]:
    """Spool position and speed a step later; the magnets know three positions: a reference beyond +-1/2 switches."""
    target = math.copysign(1.0, reference) if abs(reference) > 0.5 else 0.0
    way, reach = target - position, valve.speed * step
    if abs(way) <= reach * (1.0 + 1e-9):
        return target, 0.0
    speed = math.copysign(valve.speed, way)
    return position + speed * step, speed


@inlined
def tandem_lands(spool: float, valve: SwitchingValve) -> Lands:
    """Areas [m^2] at a spool position."""
    up, down = valve.area * max(0.0, spool), valve.area * max(0.0, -spool)
    return Lands(up, up, down, down, valve.area * (1.0 - abs(spool)))
