"""Pressure relief valve as a static curve: three straight pieces through the steady two-stage valve.

Shut up to the cracking pressure; then the pilot alone, up to the knee where the main stage opens; then the slight
slope (override) of the main stage.
"""

from typing import NamedTuple

from twin.kernel import kernel
from twin.node import Node, implicitness


class Relief(NamedTuple):
    """Corners and slopes of the static curve."""

    cracking: float  # [Pa]
    knee: float  # [Pa]
    pilot_slope: float  # [m^3/(s Pa)], between them
    main_slope: float  # [m^3/(s Pa)], beyond the knee


def relief(setting: float, setting_flow: float, override: float, pilot_band: float, pilot_flow: float) -> Relief:
    """The valve that holds `setting` [Pa] at `setting_flow` [m^3/s].

    override: [Pa s/m^3] of the main stage; pilot_band: knee less cracking pressure [Pa]; pilot_flow: at the knee.
    """
    knee = setting - override * (setting_flow - pilot_flow)
    return Relief(knee - pilot_band, knee, pilot_flow / pilot_band, 1.0 / override)


@kernel
def relief_flow(pressure: float, valve: Relief) -> float:
    """Q [m^3/s] at an inlet pressure [Pa], tank at zero."""
    if pressure <= valve.cracking:
        return 0.0
    if pressure <= valve.knee:
        return valve.pilot_slope * (pressure - valve.cracking)
    return valve.pilot_slope * (valve.knee - valve.cracking) + valve.main_slope * (pressure - valve.knee)


@kernel
def relief_slope(pressure: float, valve: Relief) -> float:
    """dQ/dp [m^3/(s Pa)]."""
    if pressure <= valve.cracking:
        return 0.0
    return valve.pilot_slope if pressure <= valve.knee else valve.main_slope


@kernel
def relieve(pressure_before: float, node: Node, valve: Relief, step: float) -> float:
    """Mean flow [m^3/s] out of a node over a step [s], theta rule, solved exactly piece by piece.

    The node is that at the end of the step with all other flows already added.
    """
    flow_before = relief_flow(pressure_before, valve)
    theta = implicitness(step * relief_slope(pressure_before, valve) / node.capacity)
    start = (node.stored - (1.0 - theta) * step * flow_before - node.volume) / node.capacity
    z = theta * step / node.capacity
    return (1.0 - theta) * flow_before + theta * _end_flow(start, z, valve)


@kernel
def _end_flow(start: float, z: float, valve: Relief) -> float:
    """Q with Q = relief_flow(start - z Q)."""
    if start <= valve.cracking:
        return 0.0
    pilot = (start - valve.cracking) * valve.pilot_slope / (1.0 + z * valve.pilot_slope)
    if start - z * pilot <= valve.knee:
        return pilot
    knee_flow = valve.pilot_slope * (valve.knee - valve.cracking)
    return (knee_flow + valve.main_slope * (start - valve.knee)) / (1.0 + z * valve.main_slope)
