"""What is fitted between the cylinder's lines and its chambers, from the numbers of a rig.

Rated flows are those of oil of 40 mm^2/s, as data sheets have them, so that a valve keeps its areas in warmer oil.
"""

import math
from collections.abc import Mapping
from typing import Any

from twin.accessory import Accessory, Joined, Necks, NoAccessory
from twin.contact import Stops
from twin.counterbalance import Counterbalance
from twin.cushion import Cushion, NoCushion, OrificeCushion, SpearCushion, spear_gap
from twin.oil import Oil
from twin.orifice import Orifice, area_for, resistance
from twin.pilot_check import PilotCheck
from twin.throttle import Throttle, ThrottleCheck
from twin.valve_body import Body, first_order_body, mass_body

Entries = Mapping[str, Any]
RATED_VISCOSITY = 40e-6  # [m^2/s], of data sheets


def necks(rig: Mapping[str, Entries], oil: Oil, step: float) -> Joined | Necks:
    """What sits between lines and chambers; lines that end in their chambers are joined to them."""
    a, b = (_accessory(rig[name], oil, step) for name in ("accessory_a", "accessory_b"))
    ends = _cushion(rig["cushion"], rig["cylinder"]["stroke"], oil)
    if isinstance(a, NoAccessory) and isinstance(b, NoAccessory) and isinstance(ends, NoCushion):
        return Joined()
    return Necks(a, b, ends)


def _accessory(valve: Entries, oil: Oil, step: float) -> Accessory:
    kind, orifice = valve["kind"], Orifice(valve["discharge"], valve["transition"])
    edge = resistance(math.pi / 4.0 * valve["diameter"] ** 2, orifice, oil)
    if kind == "counterbalance":
        return _counterbalance(valve, orifice, oil, step)
    if kind == "pilot-check":
        return _pilot_check(valve, orifice, oil, step)
    if kind == "throttle":
        return Throttle(*edge)
    if kind == "throttle-check":
        check = resistance(_rated_area(valve, "check_drop", orifice, oil), orifice, oil)
        return ThrottleCheck(*edge, float(valve["meters"] == "out"), valve["cracking"], *check)
    return NoAccessory()


def _rated_area(valve: Entries, drop: str, orifice: Orifice, oil: Oil) -> float:
    return area_for(valve["flow"], valve[drop], orifice, oil._replace(viscosity=RATED_VISCOSITY))


def _body(valve: Entries, step: float) -> Body:
    if valve["dynamics"] == "lag":
        return first_order_body(valve["time_constant"], valve["stiffness"], valve["travel"], step)
    stops = Stops(valve["travel"], valve["restitution"], valve["rest_speed"])
    return mass_body(valve["mass"], valve["damping"], valve["stiffness"], stops, step)


def _pilot_kept(valve: Entries, step: float) -> float:
    return math.exp(-step / valve["pilot_lag"]) if valve["pilot_lag"] > 0.0 else 0.0


def _counterbalance(valve: Entries, orifice: Orifice, oil: Oil, step: float) -> Counterbalance:
    check_a, check_b = resistance(_rated_area(valve, "check_drop", orifice, oil), orifice, oil)
    return Counterbalance(
        setting=valve["setting"],
        pilot_ratio=valve["pilot_ratio"],
        back_ratio=0.0 if valve["vented"] == "yes" else 1.0 + valve["pilot_ratio"],
        face=math.pi / 4.0 * valve["seat_diameter"] ** 2,
        opened=_rated_area(valve, "drop", orifice, oil),
        travel=valve["travel"],
        orifice=orifice,
        pilot_kept=_pilot_kept(valve, step),
        cracking=valve["cracking"],
        check_a=check_a,
        check_b=check_b,
        body=_body(valve, step),
    )


def _pilot_check(valve: Entries, orifice: Orifice, oil: Oil, step: float) -> PilotCheck:
    return PilotCheck(
        cracking=valve["cracking"],
        piston_ratio=valve["pilot_ratio"],
        seat=math.pi / 4.0 * valve["seat_diameter"] ** 2,
        opened=_rated_area(valve, "drop", orifice, oil),
        travel=valve["travel"],
        orifice=orifice,
        pilot_kept=_pilot_kept(valve, step),
        body=_body(valve, step),
    )


def _cushion(ends: Entries, stroke: float, oil: Oil) -> Cushion:
    lengths = ends["lower_length"], ends["upper_length"]
    if ends["kind"] == "none":
        return NoCushion()
    if sum(lengths) > stroke:
        raise ValueError(
            f"cushion.lower_length and cushion.upper_length, {lengths[0]} m and {lengths[1]} m, overlap: together at "
            f"most cylinder.stroke, {stroke} m"
        )
    if ends["kind"] == "orifice":
        orifice = Orifice(ends["discharge"], ends["transition"])
        edges = [math.pi / 4.0 * ends[name] ** 2 for name in ("lower_orifice", "upper_orifice")]
        lower, upper = (resistance(area, orifice, oil) for area in edges)
        return OrificeCushion(*lengths, *lower, *upper, stroke)
    gaps = [(ends[f"{end}_spear"], ends[f"{end}_clearance"]) for end in ("lower", "upper")]
    lower, upper = (spear_gap(*gap, ends["discharge"], oil) for gap in gaps)
    return SpearCushion(*lengths, *lower, *upper, stroke)
