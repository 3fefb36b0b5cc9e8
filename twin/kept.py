"""What channels may read of the kinds that are fitted: plain data, without numba.

A kind's sensors are named by its section of the rig and a word: `accumulator_gas_pressure`. Most show a number that the
kind keeps in its slot; the others are observed quantities, or follow from what it keeps (`twin/circuit/sensing.py`).
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from twin.topology import SENSORS, Sensor

FOLLOWS = -1  # in place of a number


class Kept(NamedTuple):
    """A sensor of a kind."""

    sensor: Sensor
    number: int = FOLLOWS  # among those of its slot


def _lift(words: str, number: int = FOLLOWS) -> Kept:
    return Kept(Sensor("m", "lift_range", f", lift of {words}"), number)


def _accessory(port: str) -> dict[str, dict[str, Kept]]:
    """Of a valve between a line and its chamber: the line's end before it, and the lift of one that has a body."""
    line = {"pressure": Kept(Sensor("Pa", "pressure_range", f" gauge, line before the accessory at {port}"), 11)}
    body = {"lift": _lift(f"the accessory at {port}", 0), **line}
    return {"counterbalance": body, "pilot-check": body, "throttle": line, "throttle-check": line}


def _stretch(words: str, number: int) -> Kept:
    return Kept(Sensor("m", "lift_range", f", {words}", signed=True), number)


KEPT: dict[str, dict[str, dict[str, Kept]]] = {  # section of the rig, its kind, and the word
    "supply": {
        "variable": {"displacement": Kept(Sensor("", "", ", of the variable pump, share of its greatest"), 0)},
    },
    "accumulator": {
        "bladder": {
            "gas_pressure": Kept(Sensor("Pa", "pressure_range", " gauge, of the accumulator's gas"), 3),
            "oil": Kept(Sensor("m^3", "volume_range", ", of oil in the accumulator"), 0),
            "flow": Kept(Sensor("m^3/s", "flow_range", ", into the accumulator", signed=True), 1),
        }
    },
    "accessory_a": _accessory("A"),
    "accessory_b": _accessory("B"),
    "relief": {
        "two-stage": {
            "pilot": _lift("the relief valve's pilot poppet"),
            "spool": _lift("the relief valve's main spool"),
        }
    },
    "friction": {"lugre": {"deflection": _stretch("mean deflection of the bristles", 0)}},
    "load": {
        "compliant": {
            "position": Kept(Sensor("m", "position_range", ", of the load behind its link")),
            "stretch": _stretch("stretch of the link, the load ahead", 0),
            "speed": Kept(Sensor("m/s", "velocity_range", ", of the load behind its link", signed=True), 1),
        }
    },
}


def kept(values: Mapping[str, Mapping[str, Any]]) -> dict[str, tuple[str, Kept]]:
    """The sensors of the kinds that a rig of some numbers has, by name, each with its slot."""
    return {
        f"{section}_{word}": (section, entry)
        for section, kinds in KEPT.items()
        for word, entry in kinds.get(values.get(section, {}).get("kind", ""), {}).items()
    }


def sensors(values: Mapping[str, Mapping[str, Any]]) -> dict[str, Sensor]:
    """All that the channels of a drive may read, of the rig's numbers."""
    return SENSORS | {name: entry.sensor for name, (_, entry) in kept(values).items()}


def channel_name(written: str) -> str:
    """A channel as messages name it; of a part of the rig it may be written with a dot."""
    return written.strip().replace(".", "_")
