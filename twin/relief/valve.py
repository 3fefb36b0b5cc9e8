"""Pilot-operated pressure relief valve, two-stage and dynamic: its numbers, and a step at the end of lines.

The oil inside is in `relief_network.py`, the moving bodies in `relief_motion.py`, steady states in `relief_steady.py`.
Symbols and signs: `README.md`, after (2.15) to (2.45) of the source. Lifts >= 0 from the seats, flow into
the valve is positive, pressures gauge, tank at zero.
"""

import math

from twin.contact import Stops
from twin.kernel import inlined
from twin.oil import Oil
from twin.orifice import Orifice, resistance
from twin.relief.long_seat import LongSeat
from twin.relief.main_stage import main_stage
from twin.relief.motion import (
    Motion,
    ReliefState,
    begin,
    substep,
    substeps,
)
from twin.relief.network import Orifices, Relief
from twin.relief.poppet import cracking_pressure, poppet

SHUT = ReliefState(0.0, 0.0, 0.0, 0.0)


def relief(
    oil: Oil,
    *,
    orifice_diameter: float,
    orifice_discharge: float,
    orifice_transition: float,
    nozzle_diameter: float,
    nozzle_discharge: float,
    nozzle_transition: float,
    seat_diameter: float,
    cone_angle: float,
    loss_factor: float,
    loss_exponent: float,
    pilot_mass: float,
    pilot_stiffness: float,
    pilot_precompression: float,
    pilot_travel: float,
    pilot_restitution: float,
    pilot_spring_diameter: float,
    pilot_spring_turns: float,
    spool_mass: float,
    spool_diameter: float,
    spool_angle: float,
    spool_length: float,
    spool_gap: float,
    spool_stiffness: float,
    spool_precompression: float,
    spool_travel: float,
    spool_restitution: float,
    spool_discharge: float,
    damping_length: float,
    rest_speed: float,
    pilot_seat: float,
    seat_length: float,
    film_floor: float,
    channel_volume: float,
) -> Relief:
    """The valve of these numbers (SI). Orifices 1 and 3 are alike, the nozzle is orifice 2; pilot_seat 1.0: long."""
    edge, nozzle = Orifice(orifice_discharge, orifice_transition), Orifice(nozzle_discharge, nozzle_transition)
    a_1, b_1 = resistance(math.pi / 4.0 * orifice_diameter**2, edge, oil)
    a_2, b_2 = resistance(math.pi / 4.0 * nozzle_diameter**2, nozzle, oil)
    return Relief(
        poppet(
            oil,
            mass=pilot_mass,
            stiffness=pilot_stiffness,
            precompression=pilot_precompression,
            spring_diameter=pilot_spring_diameter,
            spring_turns=pilot_spring_turns,
            diameter=seat_diameter,
            angle=cone_angle,
            loss_factor=loss_factor,
            loss_exponent=loss_exponent,
            stops=Stops(pilot_travel, pilot_restitution, rest_speed),
            long=LongSeat(
                pilot_seat,
                0.5 * seat_diameter,
                seat_length,
                oil.density * oil.viscosity,
                math.sin(cone_angle),
                math.cos(cone_angle),
                film_floor,
            ),
        ),
        main_stage(
            oil,
            mass=spool_mass,
            stiffness=spool_stiffness,
            precompression=spool_precompression,
            diameter=spool_diameter,
            angle=spool_angle,
            length=spool_length,
            gap=spool_gap,
            discharge=spool_discharge,
            damping_length=damping_length,
            stops=Stops(spool_travel, spool_restitution, rest_speed),
        ),
        Orifices(a_1 + a_2, b_1 + b_2, a_1, b_1),
        channel_volume / oil.bulk_modulus,
    )


@inlined
def shut(s: ReliefState) -> bool:
    """Do both bodies rest on their seats?"""
    return s.pilot_lift == 0.0 and s.pilot_velocity == 0.0 and s.spool_lift == 0.0 and s.spool_velocity == 0.0


@inlined
def go_on(m: Motion, c_before: float, c_after: float, z: float, valve: Relief, step: float) -> tuple[Motion, int]:
    """The valve a step [s] later, and the number of substeps; c goes straight from c_before to c_after."""
    if shut(m.state) and valve.capacity == 0.0:
        if max(c_before, c_after) <= cracking_pressure(valve.pilot):
            return Motion(m.state, m.y, m.pilot_force, m.pilot_oil, 0.0, 0.0), 0
        m = begin(m.state, c_before - z * m.flow, m.flow, valve)
    n = substeps(m, c_after - c_before, step, valve)
    h, slope = step, 0.0
    if n > 1:
        h, slope = step / n, (c_after - c_before) / n
    for left in range(n - 1, -1, -1):
        m = substep(m, c_after - left * slope, z, h, valve)
    return m, n


@inlined
def relieve(
    s: ReliefState, c_before: float, c_after: float, z: float, flow_before: float, valve: Relief, step: float
) -> tuple[ReliefState, float, float, int]:
    """A state a step [s] later, and Q [m^3/s], p [Pa] and the number of substeps.

    flow_before: Q at the start, so that c_before - z flow_before is the inlet's pressure there.
    """
    m, n = go_on(begin(s, c_before - z * flow_before, flow_before, valve), c_before, c_after, z, valve, step)
    return m.state, m.flow, c_after - z * m.flow, n
