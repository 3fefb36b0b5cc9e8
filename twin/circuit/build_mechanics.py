"""From the numbers of a rig to its actuator, friction and load, or one line that says why there is none."""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from twin.actuator import Actuator
from twin.air import AnyAir
from twin.circuit.oil import air_of
from twin.circuit.step import Parts
from twin.compliant import Compliant
from twin.contact import AnyStops, NoStops, Stops
from twin.cylinder import Cylinder, DrainedCylinder, HoledCylinder
from twin.environment import Environment
from twin.friction import Friction, NoFriction
from twin.lever import Lever
from twin.load import Load, buffer_stiffness
from twin.load_slot import AnyLoad, HeldLoad
from twin.lugre import LuGre
from twin.motor import Motor
from twin.oil import Oil
from twin.orifice import Orifice, resistance
from twin.rig import Values
from twin.seal import seal
from twin.stribeck import Stribeck
from twin.table import MOST_POINTS, Curve, curve_through

Entries = Mapping[str, Any]
FULL_TURN = 2.0 * math.pi


def actuator_of(rig: Values, oil: Oil) -> Actuator:
    """The cylinder or the motor."""
    air = air_of(rig, oil)
    if rig["actuator"]["kind"] == "motor":
        return _motor(rig["motor"], rig["cylinder"]["stroke"], oil, air)
    return _cylinder(rig["cylinder"], oil, air)


def _cylinder(cylinder: Entries, oil: Oil, air: AnyAir) -> Cylinder | DrainedCylinder | HoledCylinder:
    bore, rod = cylinder["bore"], cylinder["rod"]
    if rod >= bore:
        raise ValueError(f"cylinder.rod {rod} m must be thinner than cylinder.bore {bore} m")
    full, annulus = math.pi / 4.0 * bore**2, math.pi / 4.0 * (bore**2 - rod**2)
    area_lower = full if cylinder["rod_at"] == "b" else annulus
    area_upper = full if cylinder["rod_at"] == "a" else annulus
    leakage = 1.0 / cylinder["leakage_resistance"]
    outside = 1.0 / cylinder["outside_lower"], 1.0 / cylinder["outside_upper"]
    modulus = oil.bulk_modulus * cylinder["stiffness"]
    by_mass = 1.0 if cylinder["counting"] == "mass" else 0.0
    sizes = area_lower, area_upper, cylinder["dead_lower"], cylinder["dead_upper"], cylinder["stroke"], leakage
    if cylinder["wall"] == 0.0 and not any(outside) and cylinder["holes"] == "none":
        return Cylinder(*sizes, modulus, oil.vapour_pressure, air, by_mass)
    b_lower, b_upper = (_with_barrel(modulus, full / area, cylinder) for area in (area_lower, area_upper))
    drained = *sizes, *outside, b_lower, b_upper, oil.vapour_pressure
    if cylinder["holes"] == "none":
        return DrainedCylinder(*drained, air, by_mass)
    lower, upper = (_hole(cylinder, f"hole_{side}", oil) for side in ("lower", "upper"))
    return HoledCylinder(*drained, lower[0], upper[0], lower[1], upper[1], air, by_mass)


def _hole(cylinder: Entries, name: str, oil: Oil) -> tuple[float, float]:
    """(a, b) of a hole; nothing passes one without a diameter."""
    if cylinder[name] == 0.0:
        return 0.0, math.inf
    orifice = Orifice(cylinder["hole_discharge"], cylinder["hole_transition"])
    return resistance(0.25 * math.pi * cylinder[name] ** 2, orifice, oil)


def _with_barrel(modulus: float, share: float, cylinder: Entries) -> float:
    """B [Pa] of a chamber: the barrel widens by its bore's area, `share` times the chamber's, (2.8). modulus: oil's."""
    if cylinder["wall"] == 0.0:
        return modulus
    return 1.0 / (1.0 / modulus + share * cylinder["bore"] / (cylinder["wall"] * cylinder["young"]))


def _motor(motor: Entries, reach: float, oil: Oil, air: AnyAir) -> Motor:
    area = motor["displacement"] / (FULL_TURN * motor["radius"])
    case = 1.0 / motor["case_resistance"]
    return Motor(
        area, area, motor["dead_lower"], motor["dead_upper"], reach, 1.0 / motor["leakage_resistance"],
        case, case, oil.bulk_modulus, oil.vapour_pressure, motor["ripple"], motor["waves"] / motor["radius"], air,
    )  # fmt: skip


def same_kind(actuator: Actuator, parts: Parts) -> Actuator:
    """An actuator of the kind that a running circuit has; ValueError for another: it is chosen before a run."""
    if type(actuator) is not type(parts.cylinder):
        raise ValueError(
            "a cylinder without a leak to the outside cannot get one while it runs, nor the other way round; "
            "start with a tiny one: cylinder.outside_lower = 1e18 Pa s/m^3"
        )
    return actuator


def stops_of(rig: Values) -> AnyStops:
    """The cylinder's ends; a motor has none."""
    if rig["actuator"]["kind"] == "motor":
        return NoStops(rig["cylinder"]["stroke"])
    cylinder = rig["cylinder"]
    return Stops(cylinder["stroke"], cylinder["restitution"], cylinder["rest_speed"])


def friction_of(rig: Values, oil: Oil) -> Friction:
    """The friction of piston and rod, or of the shaft."""
    friction = rig["friction"]
    if friction["kind"] == "seal":
        sealed = rig["seal"]
        law = sealed["alpha"], sealed["beta"], sealed["limit"], sealed["width"]
        return seal(*law, math.pi * sealed["diameter"], sealed["downward"], oil.density * oil.viscosity)
    if friction["kind"] == "none":
        return NoFriction()
    curve = _curve_of_friction(friction)
    return curve if friction["kind"] == "stribeck" else LuGre(curve, friction["stiffness"], friction["damping"])


def _curve_of_friction(friction: Entries) -> Stribeck:
    if friction["static"] < friction["coulomb"]:
        raise ValueError(
            f"friction.static {friction['static']} N is less than friction.coulomb {friction['coulomb']} N; "
            "take at least as much"
        )
    names = "coulomb", "static", "stribeck_speed", "viscous", "pressure_area", "negative"
    return Stribeck(*(friction[name] for name in names))


def load_of(rig: Values) -> AnyLoad:
    """The load, with the gravity along its axis."""
    load, gravity, turning = rig["load"], _gravity(rig), 0.0
    if rig["actuator"]["kind"] == "motor":
        turning = rig["motor"]["inertia"] / rig["motor"]["radius"] ** 2
        gravity *= load["mass"] / (load["mass"] + turning)
    mass, around = load["mass"] + turning, Environment(*(load[name] for name in Environment._fields))
    if load["kind"] == "mass":
        return _mass(load, mass, gravity)
    if load["added"] > 0.0:
        raise ValueError(f"load.added {load['added']} kg joins a load.kind = 'mass' only; take 0 or that kind")
    if load["kind"] == "environment":
        return HeldLoad(mass, gravity, load["force"], around)
    if load["kind"] == "compliant":
        link = load["link_stiffness"], load["link_damping"]
        return Compliant(mass, load["far_mass"], *link, gravity, load["force"], around)
    return Lever(mass, _curve(load, "inertia"), _curve(load, "lift"), gravity, load["force"], around)


def _gravity(rig: Values) -> float:
    """g [m/s^2] along the axis, against the positive direction."""
    return rig["load"]["gravity"] * math.sin(rig[rig["actuator"]["kind"]]["angle"])


def _mass(load: Entries, mass: float, gravity: float) -> Load:
    if load["added"] > 0.0 > gravity:
        raise ValueError("load.added needs a support below it: take an angle of 0 to 90 deg, or load.added = 0")
    stiffness = buffer_stiffness(load["added"], load["contact_time"])
    return Load(mass, gravity, load["force"], load["added"], load["added_at"], stiffness)


def _curve(load: Entries, name: str) -> Curve:
    points = load[name]
    if not 1 <= len(points) <= MOST_POINTS:
        raise ValueError(f"load.{name} has {len(points)} points: give 1 to {MOST_POINTS}")
    if any(after[0] <= before[0] for before, after in pairwise(points)):
        raise ValueError(f"load.{name}: the positions of its points must rise")
    if name == "inertia" and min(y for _, y in points) <= 0.0:
        raise ValueError(f"load.{name}: every mass must be above 0 kg")
    return curve_through(points)
