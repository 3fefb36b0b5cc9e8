"""Pilot-operated check valve: free into the chamber, shut out of it until the pilot's piston lifts the poppet.

    F = A (max(0, r (p_pilot - p_line)) - max(0, p_chamber - p_line) - p_crack),   m x'' = F - k x - d x'  (or a lag),

A the seat's area, r that of the pilot's piston over it; p_pilot is the line side of the other port. The piston pushes
and never pulls. Into the chamber the poppet follows the flow at once: a check valve with the area that the pilot has
not opened already. So both together never pass more than the open seat.
"""

from typing import NamedTuple

from numpy.typing import NDArray

from twin.kernel import inlined
from twin.neck import Neck, checked_side, plain_side, way
from twin.oil import Oil
from twin.orifice import Orifice
from twin.valve_body import Body, move_body, steady_lift

LIFT, SPEED, FORCE, PILOT = range(4)
MEMORY = ("lift", "speed", "force", "pilot")


class PilotCheck(NamedTuple):
    """The valve."""

    cracking: float  # p_crack [Pa]
    piston_ratio: float  # r [-]
    seat: float  # A [m^2]
    opened: float  # area of the way at full lift [m^2]
    travel: float  # [m]
    orifice: Orifice
    pilot_kept: float  # share of the pilot's distance that is left after a step
    body: Body


@inlined
def lifting_force(p_line: float, p_chamber: float, p_pilot: float, valve: PilotCheck) -> float:
    """F [N] of the pilot's piston less what keeps the poppet on its seat."""
    push = max(0.0, valve.piston_ratio * (p_pilot - p_line))
    return valve.seat * (push - max(0.0, p_chamber - p_line) - valve.cracking)


@inlined
def pilot_check_at(lift: float, valve: PilotCheck, oil: Oil) -> Neck:
    """The neck at a lift [m]."""
    lifted = valve.opened * lift / valve.travel
    a, b = way(lifted, valve.orifice, oil)
    check_a, check_b = way(valve.opened - lifted, valve.orifice, oil)
    return Neck(checked_side(valve.cracking, check_a, check_b, a, b), plain_side(a, b))


@inlined
def move_pilot_check(
    valve: PilotCheck, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray, oil: Oil, step: float
) -> Neck:  # fmt: skip
    """Its neck a step [s] later, under the pressures of the last instant."""
    memory[PILOT] = p_pilot + valve.pilot_kept * (memory[PILOT] - p_pilot)
    force = lifting_force(p_line, p_chamber, memory[PILOT], valve)
    lift, speed = move_body(valve.body, memory[LIFT], memory[SPEED], force, force - memory[FORCE], step)
    memory[LIFT], memory[SPEED], memory[FORCE] = lift, speed, force
    return pilot_check_at(lift, valve, oil)


def settle_pilot_check(valve: PilotCheck, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray) -> None:
    """Its memory at rest under some pressures."""
    force = lifting_force(p_line, p_chamber, p_pilot, valve)
    memory[[LIFT, SPEED, FORCE, PILOT]] = steady_lift(valve.body, force), 0.0, force, p_pilot
