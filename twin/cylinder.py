"""Double-acting cylinder, vertical, rod down: two unequal chambers, a leak between them, a load that hangs on it.

Source: (2.10) to (2.12). l is the lower (rod side, annulus, it lifts), u the upper chamber (cap side); x from the
lower end, upwards. The load pulls down with m g; positive `force` pushes up.
"""

from typing import NamedTuple

from twin.kernel import kernel


class Cylinder(NamedTuple):
    """Areas, dead volumes and the leak."""

    area_lower: float  # A_l [m^2], annulus
    area_upper: float  # A_u [m^2], full bore
    dead_lower: float  # V_l [m^3]
    dead_upper: float  # V_u [m^3]
    stroke: float  # [m]
    leakage_resistance: float  # R_h [Pa s/m^3], across the piston seal; inf for none


class Load(NamedTuple):
    """What the piston carries."""

    mass: float  # m [kg], piston included
    gravity: float  # g [m/s^2]
    force: float  # F_ext [N], upwards


@kernel
def chamber_volumes(position: float, cylinder: Cylinder) -> tuple[float, float]:
    """Lower and upper chamber [m^3]."""
    return (
        cylinder.dead_lower + cylinder.area_lower * position,
        cylinder.dead_upper + cylinder.area_upper * (cylinder.stroke - position),
    )


@kernel
def drive(p_lower: float, p_upper: float, cylinder: Cylinder, load: Load) -> float:
    """Force on piston and load [N] without friction, (2.10)."""
    return cylinder.area_lower * p_lower - cylinder.area_upper * p_upper - load.mass * load.gravity + load.force
