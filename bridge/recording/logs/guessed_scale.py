"""How a column becomes a signal: unit and scale of a command, and the converter behind a sensor, by the values."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.recording.logs.kinds import Sure
from bridge.recording.logs.sensors import quantum
from bridge.recording.logs.table import Column

BITS = (8, 10, 12, 13, 14, 16)
NICE = (1.0, 1.5, 1.6, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)  # of ranges that transducers have
LEAST_SHARE = 0.02  # of the travel: a command that stays below is in another unit; assumed
CLOSE = 0.004  # of a range: how well a quantum must fit it
Floats = NDArray[np.float64]


class Scale(NamedTuple):
    """What a map would say of a command."""

    lines: tuple[str, ...]
    sure: Sure
    why: str


def command_scale(column: Column) -> Scale:
    """Unit and scale of a command, 1 the whole travel: by its unit, else by how far it goes."""
    most = float(np.nanmax(np.abs(column.values)))
    if column.unit == "%":
        return Scale((), Sure.SURE, "in %, 100 % the whole travel")
    if column.unit == "mA":
        return _current(column)
    if column.unit in ("V", "mV") or 1.05 < most <= 10.5:
        said = "" if column.unit else ", no unit in its head"
        return Scale((f'unit = "{column.unit or "V"}"', "scale = 0.1"), Sure.LIKELY, f"10 V assumed full travel{said}")
    if most < LEAST_SHARE:
        return Scale(('unit = ""', "scale = 1.0"), Sure.UNSURE, f"goes no further than {most:g}: in metres of spool?")
    if most <= 1.001:
        return Scale(('unit = ""', "scale = 1.0"), Sure.LIKELY, "within -1 to 1, assumed a share of the travel")
    if most <= 105.0:
        return Scale(('unit = "%"',), Sure.LIKELY, "within 100, assumed %")
    whole = 2.0 ** math.ceil(math.log2(most))
    return Scale(('unit = ""', f"scale = {1.0 / whole!r}"), Sure.UNSURE, f"counts, {whole:g} assumed full travel")


def _current(column: Column) -> Scale:
    least = float(np.nanmin(column.values))
    if least >= 3.5:
        return Scale(
            ('unit = "mA"', "scale = 125.0", "offset = -1.5"), Sure.LIKELY, "4 to 20 mA assumed, 12 mA centred"
        )
    return Scale(('unit = "mA"', "scale = 50.0"), Sure.LIKELY, "20 mA assumed full travel")


class Converter(NamedTuple):
    """A converter that would make a column's steps."""

    top: float  # of its range, from 0 or from -top
    low: float
    bits: int


def converter_of(values: Floats) -> Converter | None:
    """Range and bits whose step fits that between the values, in the column's own unit; None where nothing does."""
    step = quantum(values)
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if not step or not high > low:
        return None
    for bits in (12, *BITS):
        for span in (step * 2.0**bits,):
            nice = _nice(span)
            if nice is not None and low >= 0.0 and high <= nice:
                return Converter(nice, 0.0, bits)
            if nice is not None and low < 0.0 and max(-low, high) <= nice / 2.0:
                return Converter(nice / 2.0, -nice / 2.0, bits)
    return None


def _nice(span: float) -> float | None:
    power = 10.0 ** math.floor(math.log10(span))
    near = min((digits * power for digits in NICE), key=lambda value: abs(value - span))
    return near if abs(near - span) <= CLOSE * span else None
