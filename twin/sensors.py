"""Data acquisition: transducers and a multiplexed 12-bit card.

Source: 2.2.2. Channel j of n is read at t - (n-1-j) * skew, on the straight line through the last step, which is
inside the step unless it is shorter than the scan; noise is added in units of the card's resolution; what lies outside
a range reads as its end. The output, 0 to 10 V, has the resolution of the inputs. Each effect can be switched off.

Further channels (assumed) have the same resolution and noise. They are sampled together, at the scan's end, and the
noise of each is its own: it depends on no other channel, and the scan's does not depend on it.
"""

import math
import zlib
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.kernel import kernel
from twin.topology import CHANNELS, Sensor

NOISE_ROWS = 1024


class Card(NamedTuple):
    """The card and its transducers; ranges in the SI unit of each of CHANNELS."""

    bits: float  # resolution
    low: NDArray[np.float64]  # ends of the ranges
    high: NDArray[np.float64]
    fitted: NDArray[np.bool_]  # a channel that is not fitted takes no turn and reads NaN
    noise: float  # [LSB rms]; 0.0 for none
    skew: float  # from channel to channel [s]; 0.0 for none
    quantise: bool
    clip: bool


def card_of(daq: Any) -> Card:
    """The card that a section of settings describes: `bits`, `noise` and so on, and the range of each of CHANNELS."""
    spans = np.array([float(getattr(daq, channel.span)) for channel in CHANNELS.values()])
    signed = np.array([channel.signed for channel in CHANNELS.values()])
    fitted = np.array([bool(getattr(daq, c.switch)) if c.switch else True for c in CHANNELS.values()])
    numbers = float(daq.bits), np.where(signed, -spans, 0.0), spans, fitted, float(daq.noise), float(daq.skew)
    return Card(*numbers, bool(daq.quantise), bool(daq.clip))


def noise_block(seed: int, block: int) -> NDArray[np.float64]:
    """Unit noise for ticks block * 1024 and on, shape (1024, channels): a function of the seed and the tick alone."""
    source = np.random.Generator(np.random.Philox(key=seed, counter=[0, 0, 0, block]))
    return source.standard_normal((NOISE_ROWS, len(CHANNELS)))


class Inputs(NamedTuple):
    """Further channels; ranges in the SI unit of each."""

    low: NDArray[np.float64]
    lsb: NDArray[np.float64]  # resolution
    high: NDArray[np.float64]  # the greatest value that can be read
    quantise: bool
    clip: bool


def inputs_of(daq: Any, chosen: Mapping[str, Sensor]) -> Inputs:
    """The further channels that a section of settings describes."""
    ends = np.array([sensor.ends(daq) for sensor in chosen.values()])
    lsb = (ends[:, 1] - ends[:, 0]) / 2.0**daq.bits
    return Inputs(ends[:, 0], lsb, ends[:, 1] - lsb, bool(daq.quantise), bool(daq.clip))


def own_noise_block(seed: int, block: int, names: Iterable[str]) -> NDArray[np.float64]:
    """Unit noise of further channels as `noise_block`, a column each; of the seed, the tick and the name alone."""
    sources = (np.random.Philox(key=seed, counter=[0, zlib.crc32(name.encode()), 1, block]) for name in names)
    return np.column_stack([np.random.Generator(source).standard_normal(NOISE_ROWS) for source in sources])


def convert_all(readings: NDArray[np.float64], inputs: Inputs) -> NDArray[np.float64]:
    """What further channels read, in place, of true values with their noise; as `convert`."""
    low, lsb = inputs.low, inputs.lsb
    if inputs.quantise:
        readings -= low
        readings /= lsb
        readings += 0.5
        np.floor(readings, out=readings)
        readings *= lsb
        readings += low
    if inputs.clip:
        np.maximum(readings, low, out=readings)
        np.minimum(readings, inputs.high, out=readings)
    return readings


@kernel
def convert(value: float, low: float, high: float, noise: float, card: Card) -> float:
    """One channel: the card's reading of a value in a range, in the unit of the value."""
    lsb = (high - low) / 2.0**card.bits
    reading = value + noise * card.noise * lsb
    if card.quantise:
        reading = low + lsb * np.floor((reading - low) / lsb + 0.5)
    if card.clip:
        reading = min(max(reading, low), high - lsb)
    return reading


def put_out(reference: float, bits: float) -> float:
    """What an output of so many bits makes of a spool reference; its range is that of the references, -1 to 1.

    Rest is one of its values. The greatest is a step short of 1, as on every converter of an even number of values.
    """
    lsb = 2.0 / 2.0**bits
    return min(-1.0 + lsb * math.floor((reference + 1.0) / lsb + 0.5), 1.0 - lsb)


@kernel
def acquire(taps, noise, card: Card, step: float, out) -> None:
    """Fill `out`, one per channel, with one scan. taps: true values a step [s] before the scan's end, and at it."""
    waiting = 0
    for j in range(len(out)):
        waiting += card.fitted[j]
    for j in range(len(out)):
        if not card.fitted[j]:
            out[j] = np.nan
            continue
        waiting -= 1
        value = taps[1, j] + waiting * card.skew / step * (taps[0, j] - taps[1, j])
        out[j] = convert(value, card.low[j], card.high[j], noise[j], card)
