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
from twin.cushion import Cushion, NoCushion, cushion_losses
from twin.kernel import by_type, inlined
from twin.neck import Neck, in_series, plain_side
from twin.oil import Oil
from twin.pilot_check import PilotCheck, lifting_force, move_pilot_check, pilot_check_at, settle_pilot_check
from twin.throttle import Throttle, ThrottleCheck, throttle_check_neck, throttle_neck
from twin.valve_body import steady_lift

INFLOW, LINE = 10, 11  # in the memory of its slot: flow into the chamber, pressure at the line's end


class NoAccessory(NamedTuple):
    """Line and chamber are joined."""


Accessory = NoAccessory | Counterbalance | PilotCheck | Throttle | ThrottleCheck


class Joined(NamedTuple):
    """Both lines end in their chambers."""


class Necks(NamedTuple):
    """What lies between lines and chambers."""

    accessory_a: Accessory  # of the lower chamber
    accessory_b: Accessory  # of the upper chamber
    cushion: Cushion


def between(necks: Joined | Necks) -> Necks:
    """The same with names for what is not there."""
    return necks if isinstance(necks, Necks) else Necks(NoAccessory(), NoAccessory(), NoCushion())


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


@inlined
def cushioned(lower: Neck, upper: Neck, cushion: Cushion, position: float) -> tuple[Neck, Neck]:
    """Both necks with the cushions in series with what leaves the chambers, the piston at a position [m]."""
    a_l, b_l, a_u, b_u = cushion_losses(cushion, position)
    return Neck(lower.into, in_series(lower.out, a_l, b_l)), Neck(upper.into, in_series(upper.out, a_u, b_u))


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
