"""Pilot-operated pressure relief valve, two-stage and dynamic: its numbers, and a step at the end of lines.

The oil inside is in `network.py`, the moving bodies in `motion.py`, steady states in `steady.py`.
Symbols and signs: `README.md`, after (2.15) to (2.45) of the thesis. Lifts >= 0 from the seats, flow into
the valve is positive, pressures gauge, tank at zero.
"""

from collections.abc import Mapping
from typing import Any

from twin.kernel import inlined
from twin.oil import Oil
from twin.relief.channel import CompressibleOil, IncompressibleOil, is_compressible
from twin.relief.main_stage import main_stage
from twin.relief.motion import (
    Motion,
    ReliefState,
    begin,
    substep,
    substeps,
    with_rise,
)
from twin.relief.network import Relief, orifices
from twin.relief.poppet import cracking_pressure, poppet

SHUT = ReliefState(0.0, 0.0, 0.0, 0.0)
CURVE = 0.3e5  # [Pa], most that c may turn within a step: what turns it more is a corner, and no swing of the pilot
CUBIC = 12.0 / 31.0  # parabola and cubic err by -1/60 and 19/720 times (omega h)^4 in amplitude: so both cancel


def relief(sizes: Mapping[str, Any], oil: Oil) -> Relief:
    """The valve of a rig's numbers (SI), `pilot_precompression` in place of its setting."""
    volume = sizes["channel_volume"]
    channel = CompressibleOil(volume / oil.bulk_modulus) if volume > 0.0 else IncompressibleOil()
    return Relief(poppet(sizes, oil), main_stage(sizes, oil), orifices(sizes, oil), channel)


@inlined
def shut(s: ReliefState) -> bool:
    """Do both bodies rest on their seats?"""
    return s.pilot_lift == 0.0 and s.pilot_velocity == 0.0 and s.spool_lift == 0.0 and s.spool_velocity == 0.0


@inlined
def step_valve(m: Motion, c_before: float, c_after: float, z: float, valve: Relief, step: float) -> tuple[Motion, int]:
    """The valve a step [s] later, and the number of substeps.

    Between them c follows the parabola through c_before, c_after and the value a step earlier, and `CUBIC` of what a
    cubic through one more value adds: a straight line is 2 % short of a swing of 1.6 kHz at 50 us, and its damping
    follows from that amplitude. At a corner of c it is straight but for `CURVE`.
    """
    if shut(m.state) and not is_compressible(valve.channel):
        if max(c_before, c_after) <= cracking_pressure(valve.pilot):
            rise = c_after - c_before
            return Motion(m.state, m.y, 0.0, m.pilot_force, 0.0, 0.0, 0.0, rise, m.rise, m.pilot_oil, 0.0, 0.0), 0
        m = begin(m.state, c_before - z * m.flow, m.flow, valve, m.rise, m.rise_before)
    n = substeps(m, c_after - c_before, step, valve)
    h, rise, bend, twist = step, c_after - c_before, 0.0, 0.0
    if n > 1:
        h, bend = step / n, min(max(0.5 * (rise - m.rise), -CURVE), CURVE)
        twist = min(max(CUBIC / 6.0 * (rise - 2.0 * m.rise + m.rise_before), -CURVE), CURVE)
    for left in range(n - 1, -1, -1):
        share = left / n
        curved = (1.0 - share) * (bend + (2.0 - share) * twist)
        m = substep(m, c_after - share * (rise + curved), z, h, valve)
    return with_rise(m, rise), n


@inlined
def relieve(
    s: ReliefState, c_before: float, c_after: float, z: float, flow_before: float, valve: Relief, step: float
) -> tuple[ReliefState, float, float, int]:
    """A state a step [s] later, and Q [m^3/s], p [Pa] and the number of substeps.

    flow_before: Q at the start, so that c_before - z flow_before is the inlet's pressure there.
    """
    m = begin(s, c_before - z * flow_before, flow_before, valve, c_after - c_before, c_after - c_before)
    m, n = step_valve(m, c_before, c_after, z, valve, step)
    return m.state, m.flow, c_after - z * m.flow, n
