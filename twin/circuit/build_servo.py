"""From the numbers of a servo valve's data sheet to the valve."""

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from twin.oil import Oil
from twin.orifice import Orifice
from twin.servo_opening import InProportion, Opening, hinges
from twin.servo_spool import SpoolMotion, delay_in_steps, first_order, plays
from twin.servo_valve import Edge, ServoValve, rated_area, tightening
from twin.spool_valve import step_matrix

Entries = Mapping[str, Any]
LANDS = ("p_a", "b_t", "p_b", "a_t")
REMEMBERED = 1000


def servo_valve(valve: Entries, oil: Oil, step: float) -> ServoValve:
    """The valve at an internal step [s]; ValueError says what cannot be.

    The leakage is that of the sheet's viscosity, turned to the oil's.
    """
    orifice = Orifice(valve["discharge"], valve["transition"])
    leak = valve["leakage"] / valve["leakage_pressure"] * valve["leakage_viscosity"] / oil.viscosity
    area = rated_area(valve["rated_flow"], valve["rated_drop"], leak, orifice, oil)
    ratios = {land: valve[f"ratio_{land}"] for land in LANDS}
    edges = {land: Edge(valve[f"overlap_{land}"], ratio * area, ratio * leak) for land, ratio in ratios.items()}
    return ServoValve(
        motion=_motion(valve, step),
        opening=_opening(valve),
        **edges,
        tightening=tightening(valve["travel"], valve["clearance"]),
        null_bias=valve["null_bias"],
        flow_force=valve["flow_force"] / (area * valve["rated_drop"]),
        orifice=orifice,
    )


def _opening(valve: Entries) -> Opening:
    return hinges(valve["table"]) if valve["opening"] == "table" else InProportion()


def _motion(valve: Entries, step: float) -> SpoolMotion:
    omega, zeta = 2.0 * math.pi * valve["natural_frequency"], valve["damping"]
    second = valve["dynamics"] == "second-order"
    matrix = _second_order(omega, zeta, step) if second else first_order(valve["time_constant"], step)
    share = valve["hysteresis_share"]
    return SpoolMotion(
        *matrix,
        valve["rate"],
        *delay_in_steps(valve["delay"], step),
        *plays(valve["hysteresis"], valve["threshold"], share),
        share,
        omega**2,
        2.0 * zeta * omega,
        0.0 if second else 1.0 / valve["time_constant"],
    )


_second_order = lru_cache(REMEMBERED)(step_matrix)
