"""Throttles between a line and its chamber: a fixed edge, both ways, or one way with a check valve past it the other.

A throttle-check is free into the chamber (it meters out) or out of it (it meters in). Past the cracking pressure
its check valve opens beside the edge.
"""

from typing import NamedTuple

from twin.kernel import inlined
from twin.neck import Neck, checked_side, plain_side


class Throttle(NamedTuple):
    """dp = a Q|Q| + b Q both ways."""

    edge_a: float  # [Pa s^2/m^6]
    edge_b: float  # [Pa s/m^3]


class ThrottleCheck(NamedTuple):
    """An edge with a check valve past it."""

    throttle_a: float  # [Pa s^2/m^6]
    throttle_b: float  # [Pa s/m^3]
    meters_out: float  # 1.0: the check valve lets oil into the chamber; 0.0: out of it
    cracking: float  # [Pa]
    check_a: float
    check_b: float


@inlined
def throttle_neck(throttle: Throttle) -> Neck:
    """Both sides alike."""
    side = plain_side(throttle.edge_a, throttle.edge_b)
    return Neck(side, side)


@inlined
def throttle_check_neck(valve: ThrottleCheck) -> Neck:
    """The check valve on one side."""
    edge = plain_side(valve.throttle_a, valve.throttle_b)
    free = checked_side(valve.cracking, valve.check_a, valve.check_b, valve.throttle_a, valve.throttle_b)
    return Neck(free, edge) if valve.meters_out == 1.0 else Neck(edge, free)
