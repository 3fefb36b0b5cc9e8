"""What an estimate holds, in tables: the quantities, and what is not known of the rig. Plain data, without numba."""

from enum import IntEnum
from typing import NamedTuple

from twin.topology import CHAMBERS, CHANNELS, OBSERVED

LOAD = "load"  # estimated beside OBSERVED: what the load does to the piston, its weight included
ESTIMATED = {**OBSERVED, LOAD: "N"}  # name: SI unit
WEIGHT = 0.1  # share of the weight that the load's force is uncertain by, at the start


class Unknown(NamedTuple):
    """One of them."""

    words: str
    unit: str  # of an offset, SI; empty: a factor
    deviation: float  # of z at the start; of the load's force in weights
    drift: float  # of z [per sqrt(s)]
    fields: tuple[str, ...] = ()  # of `Parts`: those of them that the kinds fitted have


BARREL = tuple(f"cylinder.{name}" for name in ("bulk_modulus", "modulus_lower", "modulus_upper"))
LEAK = "m^3/(s Pa)"
RUBS = ("coulomb", "static", "viscous", "pressure_area")
UNKNOWNS = {
    "leakage": Unknown("leak across the piston", "", 0.3, 0.01, ("cylinder.leakage",)),
    "friction": Unknown(
        "friction of the actuator",
        "",
        0.1,
        0.03,
        ("seal.alpha", "seal.limit", *(f"seal.{name}" for name in RUBS), *(f"seal.curve.{name}" for name in RUBS)),
    ),
    "bulk_modulus": Unknown("bulk modulus of the oil in the chambers", "", 0.1, 0.005, BARREL),
    "valve_gain": Unknown(
        "area of the directional valve's lands",
        "",
        0.1,
        0.005,
        ("valve.area", *(f"valve.{land}.area" for land in ("p_a", "b_t", "p_b", "a_t"))),
    ),
    "pump_flow": Unknown("flow of the supply without a load", "", 0.1, 0.005, ("supply.delivery", "supply.ripple")),
    "pump_leakage": Unknown("leak of the supply", "", 0.2, 0.005, ("supply.leakage",)),
    "relief_setting": Unknown(
        "pressure at which the relief valve opens",
        "",
        0.03,
        0.002,
        ("relief.pilot.preload", "relief.cracking_pressure"),
    ),
    "mass": Unknown("mass of the load", "", 0.1, 0.002, ("load.mass",)),
    "load_force": Unknown("force on the load, beside its weight", "N", WEIGHT, 0.5 * WEIGHT, ("load.force",)),
    **{
        f"leak_{side}": Unknown(
            f"leak of the {side} chamber to the outside", LEAK, 0.0, 0.0, (f"cylinder.outside_{side}",)
        )
        for side in CHAMBERS
    },
    "valve_offset": Unknown("offset of the directional valve's spool", "of its travel", 0.0, 0.0),
    "filter_drop": Unknown("pressure drop of the filter", "", 0.0, 0.0, ("fitting.linear",)),
    **{
        f"offset_{name}": Unknown(f"offset of the transducer of {name}", channel.unit, 0.0, 0.0)
        for name, channel in CHANNELS.items()
    },
}
LOAD_FORCE = "load_force"
VALVE_OFFSET = "valve_offset"
LEAKS_OUTSIDE = tuple(f"leak_{side}" for side in CHAMBERS)
OFFSETS = tuple(f"offset_{name}" for name in CHANNELS)


class Standing(IntEnum):
    """How far an estimate is to be believed."""

    WAITING = 0  # no scan to begin with
    SETTLING = 1
    FOLLOWING = 2
    LOST = 3


class Use(IntEnum):
    """What is made of a channel."""

    USED = 0
    MISSING = 1  # not read, or not to be used
    SPIKE = 2  # this reading is left out
    OFF = 3  # left out until it agrees again
    STUCK = 4
