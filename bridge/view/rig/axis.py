"""The axis of the actuator in space: where its bodies lie, from the rod's side and the angle to the horizontal.

Places along it are counted from the inner end of the lower chamber, in the positive direction of the piston.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from bridge.scenario.fitted import Values, angle_of, is_motor, rod_at
from bridge.view.rig.routes import Points

STEEL = 7850.0  # [kg/m^3]
PLATE = 0.36  # [m], side of the load's plates; of a heavier one as long as it is high
PISTON = 0.04  # [m], thickness of the piston
BARREL_AT = 1.05  # [m], inner lower end of the barrel of an upright cylinder with its rod down, above the floor
ROD_FREE = 0.10  # [m], between barrel and load with the piston at its inner stop
LOWEST, RIGHTMOST = 0.15, 0.35  # [m], where bodies may be


class Axis(NamedTuple):
    """A line in space with its bodies."""

    base: Points  # inner end of the lower chamber [m]
    along: Points  # unit vector, positive direction
    normal: Points  # unit vector towards the pipes
    rods: tuple[int, ...]  # -1: through the lower chamber, 1: through the upper one
    rod_length: float  # from the piston's face to the load [m]
    plate: float  # side of the load's plates [m]
    load_height: float  # of them all, along the axis [m]

    def at(self, place: Any) -> Points:
        """Points at places [m] along the axis."""
        return self.base + np.multiply.outer(np.asarray(place, float), self.along)

    @property
    def side(self) -> int:
        """Of the load: -1 below the lower chamber, 1 beyond the upper one."""
        return self.rods[-1]

    @property
    def load_at(self) -> float:
        """Place of the load's middle, the piston at its lower stop."""
        near = self.rod_length if self.side < 0 else PISTON + self.rod_length
        return self.side * (near + 0.5 * self.load_height)

    @property
    def load_top(self) -> float:
        """Place of the load's face in the positive direction, the piston at its lower stop."""
        return self.load_at + 0.5 * self.load_height

    @property
    def outer_face(self) -> float:
        """Place of the load's face away from the rod, the piston at its lower stop."""
        return self.load_at + 0.5 * self.side * self.load_height

    def turn(self, count: int = 1) -> dict[str, Any]:
        """The rotation of bodies that are drawn upright, as an argument of Rerun's; none for an upright axis."""
        import rerun as rr

        degrees = math.degrees(math.atan2(self.along[0], self.along[2]))
        if abs(degrees) < 1e-6:
            return {}
        return {"rotation_axis_angles": [rr.RotationAxisAngle([0.0, 1.0, 0.0], degrees=degrees)] * count}


def plates(mass: float) -> tuple[float, float]:
    """Side and height [m] of steel plates of a mass [kg]."""
    volume = mass / STEEL
    side = max(PLATE, volume ** (1.0 / 3.0))
    return side, volume / side**2


def axis_of(values: Values, stroke: float, added: float) -> Axis:
    """The axis of a drive: the rod points away from the pipes, everything above the floor; added: a weight's height."""
    if is_motor(values):
        return _motor_axis()
    rods = {"a": (-1,), "b": (1,), "both": (-1, 1)}[rod_at(values)]
    angle = angle_of(values)
    along = np.array([-rods[-1] * math.cos(angle), 0.0, math.sin(angle)])
    along[np.abs(along) < 1e-9] = 0.0
    axis = Axis(np.zeros(3), along, _normal(along), rods, stroke + ROD_FREE + added, *plates(values["load"]["mass"]))
    return axis._replace(base=_base(axis, stroke))


def _motor_axis() -> Axis:
    up = np.array([0.0, 0.0, 1.0])
    return Axis(np.array([0.0, 0.0, BARREL_AT]), up, np.array([1.0, 0.0, 0.0]), (1,), 0.0, PLATE, 0.0)


def _normal(along: Points) -> Points:
    across = np.array([along[2], 0.0, -along[0]])
    return across if across @ np.array([1.0, 0.0, 1.0]) >= 0.0 else -across


def _base(axis: Axis, stroke: float) -> Points:
    """Where the lower chamber begins, so that no body leaves the room at either stop."""
    places = [0.0, stroke + PISTON, axis.outer_face, axis.outer_face + stroke]
    if len(axis.rods) == 2:
        places.append(-axis.rod_length)
    reach = np.multiply.outer(np.array(places), axis.along)
    half = 0.5 * axis.plate * abs(axis.along[0])  # of the load's plates, upwards
    hangs = axis.along[2] > 0.99 and axis.side < 0
    high = max(BARREL_AT if hangs else 0.6, LOWEST + half - float(reach[:, 2].min()))
    return np.array([min(0.0, RIGHTMOST - float(reach[:, 0].max())), 0.0, high])
