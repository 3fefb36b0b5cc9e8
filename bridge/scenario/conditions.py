"""Conditions on a signal, in words: "p2 > 60 bar", "velocity < 0", "measurement.p1 > 100 bar"."""

import math
import re
from collections.abc import Mapping
from typing import NamedTuple

from bridge.errors import nearest
from bridge.scenario.units import quantity, shown, split
from twin.topology import CHANNELS, OBSERVED

CROSSED = re.compile(r"\s*((?:[a-z]+\.)?\w+)\s*([<>])\s*(.+?)\s*")
MEASURED = "measurement"  # before the dot: what the card read, also where a true signal has the name
SIGNALS = OBSERVED | {name: channel.unit for name, channel in CHANNELS.items() if name not in OBSERVED}
READ = {f"{MEASURED}.{name}": channel.unit for name, channel in CHANNELS.items()}


class Crossing(NamedTuple):
    """A signal goes past a limit."""

    signal: str  # of SIGNALS, of READ, or "channels.NAME"
    upwards: bool
    limit: float  # SI


def crossing(text: str, instead: str = "", further: Mapping[str, str] = {}, strict: bool = False) -> Crossing:
    """What a text waits for. Raises ValueError.

    instead: what else may stand there, in words. further: more signals, and their units. strict: a limit states its
    unit, where it could be meant in another one.
    """
    known = {**SIGNALS, **READ, **further}
    match = CROSSED.fullmatch(text)
    if match is None:
        raise ValueError(f"when {text!r}: write 'signal > value unit'{instead}")
    if match[1] not in known:
        raise ValueError(f"when {text!r}: no signal {match[1]!r}{nearest(match[1], known)}")
    unit = known[match[1]]
    limit = quantity(match[3], unit)
    factor, name = shown(unit)
    if not math.isfinite(limit):
        raise ValueError(f"when {text!r}: {match[3]} is not a finite number")
    if strict and name != unit and limit != 0.0 and not split(match[3])[1]:
        raise ValueError(
            f"when {text!r}: {match[3]} has no unit, and would be {limit * factor:g} {name}: "
            f"write '{match[3]} {name}' or another unit"
        )
    return Crossing(match[1], match[2] == ">", limit)


def unit_of(condition: Crossing, further: Mapping[str, str] = {}) -> str:
    """The unit of a condition's signal, SI."""
    return {**SIGNALS, **READ, **further}[condition.signal]


def crosses(condition: Crossing, value: float) -> bool:
    """Is a signal past its limit?"""
    return value > condition.limit if condition.upwards else value < condition.limit


def gone(condition: Crossing, value: float, hysteresis: float) -> bool:
    """Is a signal back on the good side of its limit, by a hysteresis? One without a value (NaN) is not."""
    return value <= condition.limit - hysteresis if condition.upwards else value >= condition.limit + hysteresis
