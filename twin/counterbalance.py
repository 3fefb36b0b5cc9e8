"""Counterbalance (overcentre) valve: holds a load on its chamber until chamber or pilot pressure opens it.

Chamber to line, over a spool or poppet of lift x on a spring:

    F = A (p_chamber + r p_pilot - w p_line - p_set),   m x'' = F - k x - d x'  (or a lag),   area = A_full x/travel,

r the pilot ratio, p_pilot the line side of the other port, behind a lag for a damping orifice. The line's pressure
lies on the spring's side: w = 1 + r, so that it adds to the setting (data sheets of such valves: 1 + r times the back
pressure); with a vented spring chamber w = 0. Line to chamber, a check valve beside it opens at its cracking pressure.
Flow forces are left out.
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


class Counterbalance(NamedTuple):
    """The valve; its setting is the chamber pressure that cracks it, pilot and line at 0."""

    setting: float  # p_set [Pa]
    pilot_ratio: float  # r [-]
    back_ratio: float  # w [-]
    face: float  # A [m^2], of the chamber's pressure
    opened: float  # A_full [m^2]
    travel: float  # [m]
    orifice: Orifice
    pilot_kept: float  # share of the pilot's distance that is left after a step
    cracking: float  # of the check valve [Pa]
    check_a: float  # [Pa s^2/m^6]
    check_b: float  # [Pa s/m^3]
    body: Body


@inlined
def opening_force(p_line: float, p_chamber: float, p_pilot: float, valve: Counterbalance) -> float:
    """F [N] of the oil less the spring's preload."""
    opening = p_chamber + valve.pilot_ratio * p_pilot - valve.back_ratio * p_line
    return valve.face * (opening - valve.setting)


@inlined
def counterbalance_at(lift: float, valve: Counterbalance, oil: Oil) -> Neck:
    """The neck at a lift [m]."""
    a, b = way(valve.opened * lift / valve.travel, valve.orifice, oil)
    return Neck(checked_side(valve.cracking, valve.check_a, valve.check_b, a, b), plain_side(a, b))


@inlined
def move_counterbalance(
    valve: Counterbalance, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray, oil: Oil, step: float
) -> Neck:  # fmt: skip
    """Its neck a step [s] later, under the pressures of the last instant."""
    memory[PILOT] = p_pilot + valve.pilot_kept * (memory[PILOT] - p_pilot)
    force = opening_force(p_line, p_chamber, memory[PILOT], valve)
    lift, speed = move_body(valve.body, memory[LIFT], memory[SPEED], force, force - memory[FORCE], step)
    memory[LIFT], memory[SPEED], memory[FORCE] = lift, speed, force
    return counterbalance_at(lift, valve, oil)


def settle_counterbalance(
    valve: Counterbalance, p_line: float, p_chamber: float, p_pilot: float, memory: NDArray
) -> None:
    """Its memory at rest under some pressures."""
    force = opening_force(p_line, p_chamber, p_pilot, valve)
    memory[[LIFT, SPEED, FORCE, PILOT]] = steady_lift(valve.body, force), 0.0, force, p_pilot
