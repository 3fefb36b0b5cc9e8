"""What sits between the end of a cylinder's line and its chamber: nothing, or one of the valves of this table.

All take the pressures of the last instant and give the neck of the next; those with a body move it first.
"""

from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.counterbalance import (
    Counterbalance,
    counterbalance_at,
    move_counterbalance,
    opening_force,
    settle_counterbalance,
)
from twin.kernel import by_type
from twin.neck import Neck, plain_side
from twin.oil import Oil
from twin.pilot_check import PilotCheck, lifting_force, move_pilot_check, pilot_check_at, settle_pilot_check
from twin.throttle import Throttle, ThrottleCheck, throttle_check_neck, throttle_neck
from twin.valve_body import steady_lift


class NoAccessory(NamedTuple):
    """Line and chamber are joined."""


Accessory = NoAccessory | Counterbalance | PilotCheck | Throttle | ThrottleCheck


@by_type
def accessory_neck(
    accessory: Any, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray, oil: Oil, step: float
) -> Neck:
    """The neck a step [s] later; p_pilot: of the line at the other port. Its body moves in `memory`."""
    raise TypeError(f"{accessory} is not an accessory")


@accessory_neck.register
def _(
    accessory: NoAccessory, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray, oil: Oil, step: float
) -> Neck:
    side = plain_side(0.0, 0.0)
    return Neck(side, side)


@accessory_neck.register
def _(
    accessory: Counterbalance, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray, oil: Oil, step: float
) -> Neck:
    return move_counterbalance(accessory, p_line, p_chamber, p_pilot, memory, oil, step)


@accessory_neck.register
def _(
    accessory: PilotCheck, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray, oil: Oil, step: float
) -> Neck:
    return move_pilot_check(accessory, p_line, p_chamber, p_pilot, memory, oil, step)


@accessory_neck.register
def _(
    accessory: Throttle, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray, oil: Oil, step: float
) -> Neck:
    return throttle_neck(accessory)


@accessory_neck.register
def _(
    accessory: ThrottleCheck, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray, oil: Oil, step: float
) -> Neck:
    return throttle_check_neck(accessory)


@by_type
def is_joined(accessory: Any) -> bool:
    """Are line and chamber one place?"""
    raise TypeError(f"{accessory} is not an accessory")


@is_joined.register
def _(accessory: NoAccessory) -> bool:
    return True


@is_joined.register
def _(accessory: Counterbalance) -> bool:
    return False


@is_joined.register
def _(accessory: PilotCheck) -> bool:
    return False


@is_joined.register
def _(accessory: Throttle) -> bool:
    return False


@is_joined.register
def _(accessory: ThrottleCheck) -> bool:
    return False


def begin_accessory(accessory: Accessory, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray) -> None:
    """Its memory at rest under some pressures [Pa]."""
    if isinstance(accessory, Counterbalance):
        settle_counterbalance(accessory, p_line, p_chamber, p_pilot, memory)
    if isinstance(accessory, PilotCheck):
        settle_pilot_check(accessory, p_line, p_chamber, p_pilot, memory)


@by_type
def resting_neck(accessory: Any, p_line: float, p_chamber: float, p_pilot: float, oil: Oil) -> Neck:
    """The neck with the body at rest under some pressures [Pa]."""
    raise TypeError(f"{accessory} is not an accessory")


@resting_neck.register
def _(accessory: NoAccessory, p_line: float, p_chamber: float, p_pilot: float, oil: Oil) -> Neck:
    side = plain_side(0.0, 0.0)
    return Neck(side, side)


@resting_neck.register
def _(accessory: Counterbalance, p_line: float, p_chamber: float, p_pilot: float, oil: Oil) -> Neck:
    force = opening_force(p_line, p_chamber, p_pilot, accessory)
    return counterbalance_at(steady_lift(accessory.body, force), accessory, oil)


@resting_neck.register
def _(accessory: PilotCheck, p_line: float, p_chamber: float, p_pilot: float, oil: Oil) -> Neck:
    force = lifting_force(p_line, p_chamber, p_pilot, accessory)
    return pilot_check_at(steady_lift(accessory.body, force), accessory, oil)


@resting_neck.register
def _(accessory: Throttle, p_line: float, p_chamber: float, p_pilot: float, oil: Oil) -> Neck:
    return throttle_neck(accessory)


@resting_neck.register
def _(accessory: ThrottleCheck, p_line: float, p_chamber: float, p_pilot: float, oil: Oil) -> Neck:
    return throttle_check_neck(accessory)
