"""Which of the rig's values are in force: those of what is fitted."""

from bridge.scenario.fitted import SLOTS, Values, has_relief_line, is_motor, kind_of, word
from twin.topology import PIPES, RELIEF_LINE

HELD = ("counterbalance", "pilot-check")  # accessories with a body
CHECKED = ("counterbalance", "pilot-check", "throttle-check")
THROTTLES = ("throttle", "throttle-check")
AROUND = ("environment", "compliant", "lever")
SLIDING = ("stribeck", "lugre")
WAVES = ("ends", "nodes", "lumped")
Only = dict[str, tuple[str, ...]]  # name -> kinds of its section that read it


def _accessory() -> Only:
    own = ("seat_diameter", "travel", "stiffness", "dynamics", "mass", "damping", "restitution", "rest_speed", "drop")
    return {
        **dict.fromkeys((*own, "time_constant", "pilot_ratio", "pilot_lag"), HELD),
        **dict.fromkeys(("setting", "vented"), ("counterbalance",)),
        "check_drop": ("counterbalance", "throttle-check"),
        "cracking": CHECKED,
        "flow": CHECKED,
        **dict.fromkeys(("diameter", "discharge", "transition"), THROTTLES),
        "meters": ("throttle-check",),
    }


def _ends(what: str) -> tuple[str, str]:
    return f"lower_{what}", f"upper_{what}"


KIND_READS: dict[str, Only] = {  # where a section has numbers of several kinds; others are read by all
    "accessory_a": _accessory(),
    "accessory_b": _accessory(),
    "cushion": {
        **dict.fromkeys(_ends("orifice"), ("orifice",)),
        **dict.fromkeys((*_ends("spear"), *_ends("clearance")), ("spear",)),
    },
    "friction": {
        **dict.fromkeys(("coulomb", "static", "stribeck_speed", "viscous", "pressure_area", "negative"), SLIDING),
        **dict.fromkeys(("stiffness", "damping"), ("lugre",)),
    },
    "load": {
        **dict.fromkeys(("added", "added_at", "contact_time"), ("mass",)),
        **dict.fromkeys(("stiffness", "neutral", "viscous", "quadratic"), AROUND),
        **dict.fromkeys(("far_mass", "link_stiffness", "link_damping"), ("compliant",)),
        **dict.fromkeys(("inertia", "lift"), ("lever",)),
    },
    "return_end": {
        **dict.fromkeys(("diameter", "discharge", "transition"), ("orifice", "check")),
        "cracking_pressure": ("check",),
    },
    "oil": {
        "density": ("thesis", "numbers"),
        "wave_speed": ("thesis",),
        "temperature": ("thesis", "iso-vg"),
        "bulk_modulus": ("numbers", "iso-vg"),
        "viscosity": ("numbers",),
        "grade": ("iso-vg",),
    },
}
PIPE_READS: Only = {
    **dict.fromkeys(("length", "diameter", "wall", "young"), (*WAVES, "volume")),
    "friction": WAVES,
    "manifold": ("none",),
}
WITH_CREEP = ("creep", "retardation", "creep_2", "retardation_2")
SERVO_READS: dict[str, Only] = {  # by another choice of its section
    "dynamics": {
        **dict.fromkeys(("natural_frequency", "damping"), ("second-order",)),
        "time_constant": ("first-order",),
    },
    "opening": {"table": ("table",)},
}
OF_SLOTS = {section for slot in SLOTS.values() for kind in slot.kinds.values() for section in kind.sections}
EMPTY = ("minor_losses", "amplifier", "cushion", "accumulator", "check_valve", "accessory_a", "accessory_b")  # if none


def in_force(values: Values) -> set[str]:
    """Names of the values, as "part.name", that the drive reads."""
    return {
        f"{section}.{name}" for section, entries in values.items() for name in entries if _reads(values, section, name)
    }


def _reads(values: Values, section: str, name: str) -> bool:
    if not _section_is_fitted(values, section):
        return section == "cylinder" and name == "stroke"
    if name == "kind":
        return True
    if section in (*PIPES, RELIEF_LINE):
        return _of_kind(PIPE_READS, name, values[section]["model"]) and not _idle_creep(values, section, name)
    if section == "servo_valve":
        return all(_of_kind(reads, name, word(values, f"servo_valve.{by}")) for by, reads in SERVO_READS.items())
    if section == "relief":
        return name == "place" or (kind_of(values, "relief valve") == "two-stage" and not _of_other_seat(values, name))
    if section == "valve":
        return name == "full_scale" or kind_of(values, "directional valve") == "proportional"
    return _of_kind(KIND_READS.get(section, {}), name, word(values, f"{section}.kind"))


def _of_other_seat(values: Values, name: str) -> bool:
    return name in ("seat_length", "film_floor") and values["relief"]["pilot_seat"] != "conical"


def _of_kind(reads: Only, name: str, kind: object) -> bool:
    return kind is None or kind in reads.get(name, (kind,))


def _section_is_fitted(values: Values, section: str) -> bool:
    if section == RELIEF_LINE:
        return has_relief_line(values)
    if section in OF_SLOTS:
        return any(section in slot.kinds[kind_of(values, name)].sections for name, slot in SLOTS.items())
    if section == "cushion" and is_motor(values):
        return False
    return section not in EMPTY or word(values, f"{section}.kind") != "none"


def _idle_creep(values: Values, pipe: str, name: str) -> bool:
    """A wall that does not creep has no time of creeping."""
    if name not in WITH_CREEP:
        return False
    return not values[pipe][name.replace("retardation", "creep")] if name.startswith("retardation") else False
