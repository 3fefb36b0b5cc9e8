"""The signals of a recording: the numbers of its flat messages and of laws, by the instants they belong to."""

import re
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.recording.own_signals import TOPIC as OWN_SIGNALS
from bridge.recording.own_signals import own_units
from bridge.recording.reader import Recording
from bridge.scenario.bands import SIGNALS
from bridge.wire.messages import CHANNELS_TOPIC, TOPICS, described, of_tap, struct_format
from controller.grid import NS
from twin.topology import PRESSURES

COMPARED = ("measurement", CHANNELS_TOPIC, "state", "command", "reference", "signals")
INSTANTS = {"command": "sample_stamp"}  # of others "stamp"
IDENTITY = ("run_id", "source", "sequence", "tick", "stamp", "sample_stamp")
_COMMENT = re.compile(r"^\S+ (\w+)\s*#(.*)$", re.MULTILINE)
_UNIT = re.compile(r"\[([^\]]+)\]")
_UNITS = re.compile(r"\s*\[[^\]]+\]")  # with the blank before it


class Signal(NamedTuple):
    """One number over time."""

    name: str  # topic.field
    unit: str
    stamp: NDArray[np.int64]  # [ns]
    value: NDArray[np.float64]  # an `apply_at` in seconds


def units(topic: str) -> dict[str, str]:
    """Unit of each field of a topic, as the message table states it; "" where there is none."""
    stated = {name: (_UNIT.search(comment) or ["", ""])[1] for name, comment in _COMMENT.findall(_text(topic))}
    stated = {name: unit for name, unit in stated.items() if (unit and " " not in unit) or unit in _SPACED}
    return stated | ({n: u for n, u in SIGNALS.items() if u} if topic == "state" else {}) | _STANDARD.get(topic, {})


_SPACED = ("Pa s/m^3",)
_STANDARD = {"joint": {"position": "m", "velocity": "m/s", "effort": "N"}} | {
    topic: {"fluid_pressure": "Pa", "variance": "Pa^2"} for topic in map(of_tap, PRESSURES)
}
_STANDARD |= {
    topic: {"stamp": "ns"} for topic in ("measurement", CHANNELS_TOPIC, "state", "timing", "lines", "signals")
}


def units_in(recording: Recording, topic: str) -> dict[str, str]:
    """The same in a recording, which alone knows the units of further channels and of what a law has logged."""
    if topic == CHANNELS_TOPIC:
        return units(topic) | {field.name: field.unit for field in recording.layout()}
    return units(topic) | (own_units(recording) if topic == OWN_SIGNALS else {})


def comments_in(recording: Recording, topic: str) -> dict[str, str]:
    """What the message table says of the fields of a topic besides their units, of those of which it says anything."""
    said = {name: _UNITS.sub("", comment, count=1) for name, comment in _COMMENT.findall(_text(topic))}
    if topic == CHANNELS_TOPIC:
        said |= {field.name: field.note for field in recording.layout()}
    return {name: words for name, text in said.items() if (words := text.strip(" ,:;"))}


def has_columns(topic: str) -> bool:
    """Is a message of a topic a row of numbers?"""
    return topic == OWN_SIGNALS or struct_format(TOPICS[topic].type) is not None


def _text(topic: str) -> str:
    return described(TOPICS[topic].type)


def signals_of(recording: Recording, topics: tuple[str, ...] = COMPARED) -> dict[str, Signal]:
    """Every signal of some topics, in the order of their instants."""
    found = {}
    for topic in topics:
        if recording.counts.get(topic) and has_columns(topic):
            rows = _of_topic(topic, recording.columns(topic), units_in(recording, topic))
            found |= {signal.name: signal for signal in rows}
    return found


def _of_topic(topic: str, columns: dict[str, NDArray[Any]], known: dict[str, str]) -> list[Signal]:
    stamp = columns[INSTANTS.get(topic, "stamp")].astype(np.int64)
    order = np.argsort(stamp, kind="stable")
    signals = []
    for name, values in columns.items():
        if name in IDENTITY:
            continue
        unit, value = known.get(name, ""), values[order].astype(np.float64)
        if unit == "ns":
            unit, value = "s", value / NS
        signals.append(Signal(f"{topic}.{name}", unit, stamp[order], value))
    return signals
