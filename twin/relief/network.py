"""The oil inside the relief valve, solved together with the speeds of its two bodies.

    inlet p --orifices 1, 2--> p2 --pilot seat--> tank        p3 --orifice 3--> p2
    inlet p --main seat------> tank                           the opening spool pushes A v from p3 through orifice 3

Symbols and signs: `README.md`, after (2.15) to (2.19), corrected (2.28), (2.39). Flows in the direction of
the arrows. Q1 = Q2, Q_pl + A_in u = Q2 + A v, p3 = p2 + dp3(A v). The spool draws A v from the inlet and the poppet
hands A_in u to the tank, so what goes in comes out: Q = Q_main + Q1 + A v. The inlet is the end of lines, p = c - z Q.

The oil before the pilot seat may be compressible: C p2' = Q2 + A v - Q_pl - A_in u, by the trapezoidal rule, which
takes no energy from a swing. Without it (C = 0, the thesis) the pilot cannot chatter by its own oil.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from twin.contact import stopped
from twin.kernel import inlined
from twin.oil import Oil
from twin.orifice import Orifice, quadratic_flow, resistance
from twin.relief.channel import Channel, is_compressible
from twin.relief.main_stage import (
    MainStage,
    main_opening,
    spool_drag,
    spool_spring,
)
from twin.relief.poppet import Poppet
from twin.relief.seat import is_laminar

ITERATIONS = 8
LEAST_OPENING = 0.5  # of the predicted one: what a correction of the poppet's lift leaves within a substep
CLOSE_SPEED, CLOSE_ROOT = 1e-4, 1e-3  # [m/s] and relative: a smaller correction is the last, its error is of its square


class Orifices(NamedTuple):
    """dp = a Q|Q| + b Q, a [Pa s^2/m^6], b [Pa s/m^3]."""

    a_12: float  # orifices 1 and 2 in series
    b_12: float
    a_3: float  # orifice 3, the damper
    b_3: float


def orifices(sizes: Mapping[str, Any], oil: Oil) -> Orifices:
    """The orifices of a rig's numbers for its relief valve (SI): 1 and 3 are alike, the nozzle is orifice 2."""
    edge = Orifice(sizes["orifice_discharge"], sizes["orifice_transition"])
    nozzle = Orifice(sizes["nozzle_discharge"], sizes["nozzle_transition"])
    a_1, b_1 = resistance(math.pi / 4.0 * sizes["orifice_diameter"] ** 2, edge, oil)
    a_2, b_2 = resistance(math.pi / 4.0 * sizes["nozzle_diameter"] ** 2, nozzle, oil)
    return Orifices(a_1 + a_2, b_1 + b_2, a_1, b_1)


class Relief(NamedTuple):
    """The whole valve."""

    pilot: Poppet
    main: MainStage
    orifices: Orifices
    channel: Channel  # the oil before the pilot seat


@inlined
def drop(q: float, a: float, b: float) -> float:
    """Pressure drop [Pa] of a flow [m^3/s]."""
    return (a * abs(q) + b) * q


@inlined
def pilot_node(p: float, pushed: float, conductance: float, orifices: Orifices, laminar: float = 0.0) -> float:
    """y [sqrt(Pa)] with p2 = y|y|, or, with the seat shut, p2 itself [Pa], at a given inlet pressure.

    y|y| + dp12(R y - pushed) = p rises with y and is a quadratic on each side of y = 0 and of R y = pushed [m^3/s],
    which is what both bodies push into the node: closed form. laminar: G of a long seat, y then p2 itself.
    """
    if laminar > 0.0:
        through = quadratic_flow(p - pushed / laminar, orifices.a_12, orifices.b_12 + 1.0 / laminar)
        return (through + pushed) / laminar
    lifted = -drop(-pushed, orifices.a_12, orifices.b_12)
    if conductance <= 0.0:
        return p + lifted
    a = math.copysign(orifices.a_12, p * conductance**2 - pushed * abs(pushed))
    square = math.copysign(1.0, p + lifted) + a * conductance**2
    linear = conductance * (orifices.b_12 - 2.0 * a * pushed)
    rest = a * pushed**2 - orifices.b_12 * pushed - p
    root = math.sqrt(max(0.0, linear * linear - 4.0 * square * rest))
    if linear > 0.0:
        return -2.0 * rest / (linear + root)
    return 0.5 * (root - linear) / square


class PoppetEnd(NamedTuple):
    """The poppet at the end of a substep: its lift but for a small correction is known, the rest follows from p2."""

    lift: float  # predicted [m]
    conductance: float  # R there [m^3/(s sqrt(Pa))]
    corrected: float  # R at the corrected lift, but for what p2 adds
    corrected_per_p2: float  # gained per p2 [m^3/(s Pa^1.5)]
    speed: float  # u without p2 [m/s]
    speed_per_p2: float  # gained per p2 [m/(s Pa)]
    sweeping: float  # speed at which the poppet sweeps oil, without p2 [m/s]
    sweeping_per_p2: float
    outflow_per_p2: float  # what leaves the node through a laminar seat and into its oil [m^3/(s Pa)]
    inflow: float  # less this [m^3/s]


class SpoolEnd(NamedTuple):
    """The spool at the end of a substep: a lift and a speed to which a force adds."""

    lift: float  # but for what the speed at the end adds [m]
    velocity: float  # v that no force would change [m/s]
    guess: float  # v from which the iteration starts [m/s]
    inertia: float  # (3/2 + THIRD + FOURTH) m/h [N s/m]
    lift_per_speed: float  # 5 h/12 [s]; 0.0 for a spool whose end is given


class Residuals(NamedTuple):
    """A guess put into the equations: errors, their slopes, and what it means."""

    node: float  # p2 + dp12 - p [Pa]
    node_y: float
    node_v: float
    force: float  # on the spool [N]
    force_y: float
    force_v: float
    flow: float  # Q [m^3/s]
    flow_y: float
    flow_v: float


class Solution(NamedTuple):
    """What the end of a substep has in common for both bodies."""

    y: float  # as of `pilot_node`
    spool_velocity: float
    spool_force: float
    flow: float


@inlined
def residuals(y: float, v: float, poppet: PoppetEnd, spool: SpoolEnd, c: float, z: float, valve: Relief) -> Residuals:
    """The equations at a guess. The inlet's p + z k sqrt(p) = c - z q is solved for s = sqrt(p) in closed form."""
    pilot, main, orifices = valve.pilot, valve.main, valve.orifices
    lift = spool.lift + spool.lift_per_speed * v
    seat = main_opening(lift, main)
    k_v = spool.lift_per_speed * seat.conductance_slope
    p2, p2_y = (y * abs(y), 2.0 * abs(y)) if poppet.conductance > 0.0 else (y, 1.0)
    free = poppet.sweeping + poppet.sweeping_per_p2 * p2
    u = stopped(poppet.lift, free, pilot.stops)
    u_y = poppet.sweeping_per_p2 * p2_y if u == free else 0.0
    wide = max(poppet.corrected + poppet.corrected_per_p2 * p2, LEAST_OPENING * poppet.conductance)
    wide_y = wide + poppet.corrected_per_p2 * p2_y * y
    q, q_y = wide * y + pilot.area * u, wide_y + pilot.area * u_y
    if is_laminar(pilot.seat) or is_compressible(valve.channel):
        q, q_y = q + (poppet.outflow_per_p2 * p2 - poppet.inflow), q_y + poppet.outflow_per_p2 * p2_y
    e, zk = c - z * q, z * seat.conductance
    root = math.sqrt(zk * zk + 4.0 * abs(e)) + 1e-30
    s, per_root = math.copysign(0.5 * (root - zk), e), 1.0 / root
    s_y, s_v = -z * q_y * per_root, -z * s * k_v * per_root
    p, p_y, p_v = s * abs(s), 2.0 * abs(s) * s_y, 2.0 * abs(s) * s_v
    q1, q3 = q - main.area * v, main.area * v
    stiff_12 = 2.0 * orifices.a_12 * abs(q1) + orifices.b_12
    stiff_3 = 2.0 * orifices.a_3 * abs(q3) + orifices.b_3
    drag, lifting = spool_drag(abs(s), main), seat.area_slope * p - main.stiffness
    p3 = p2 + drop(q3, orifices.a_3, orifices.b_3)
    return Residuals(
        node=p2 + drop(q1, orifices.a_12, orifices.b_12) - p,
        node_y=p2_y + stiff_12 * q_y - p_y,
        node_v=-stiff_12 * main.area - p_v,
        force=seat.area * p - main.area * p3 - spool_spring(lift, main) - drag * v,
        force_y=seat.area * p_y - main.area * p2_y,
        force_v=seat.area * p_v - main.area**2 * stiff_3 - drag + spool.lift_per_speed * lifting,
        flow=seat.conductance * s + q,
        flow_y=seat.conductance * s_y + q_y,
        flow_v=seat.conductance * s_v + k_v * s,
    )


@inlined
def solve(y: float, poppet: PoppetEnd, spool: SpoolEnd, c: float, z: float, valve: Relief) -> Solution:
    """The end of a substep: Newton on the pilot node, from a guess y, and on the spool's motion together.

    Unknown are y and the spool's speed v at the end. Each equation rises with its own unknown, and the determinant has
    the floor that inertia gives it. The last correction is carried into the results by their slopes.
    """
    v = spool.guess
    dy = dv = 0.0
    iterations = 0
    while True:
        at = residuals(y, v, poppet, spool, c, z, valve)
        iterations += 1
        per_node = 1.0 / at.node_y
        if spool.lift_per_speed > 0.0:
            error = spool.inertia * (v - spool.velocity) - at.force
            determinant = at.node_y * (spool.inertia - at.force_v) + at.node_v * at.force_y
            determinant = max(determinant, 0.5 * at.node_y * spool.inertia)
            dv = -(error * at.node_y + at.node * at.force_y) / determinant
        dy = -(at.node + at.node_v * dv) * per_node
        y, v = y + dy, v + dv
        if iterations == ITERATIONS or (abs(dv) <= CLOSE_SPEED and abs(dy) <= CLOSE_ROOT * (abs(y) + 1.0)):
            break
    return Solution(
        y,
        v,
        at.force + at.force_y * dy + at.force_v * dv,
        at.flow + at.flow_y * dy + at.flow_v * dv,
    )
