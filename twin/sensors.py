"""Data acquisition: transducers and a multiplexed 12-bit card.

Source: 2.2.2. Channel j of n is read at t - (n-1-j) * skew, interpolated inside the last step; noise is added in
units of the card's resolution; what lies outside a range reads as its end. Each effect can be switched off.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.kernel import kernel

CHANNELS = ("position", "velocity", "p1", "p2", "p3")
NOISE_ROWS = 1024


class Card(NamedTuple):
    """The card and its transducers; lengths in m, pressures in Pa."""

    bits: float  # resolution
    position_range: float  # 0 .. [m]
    velocity_range: float  # -+ [m/s], tachometer
    pressure_range: float  # 0 .. [Pa]
    noise: float  # [LSB rms]; 0.0 for none
    skew: float  # from channel to channel [s]; 0.0 for none
    quantise: bool
    clip: bool
    tachometer: bool  # False: no such channel, velocity reads NaN


def noise_block(seed: int, block: int) -> NDArray[np.float64]:
    """Unit noise for ticks block * 1024 and on, shape (1024, 5): a function of the seed and the tick alone."""
    return np.random.Generator(np.random.Philox(key=seed, counter=[0, 0, 0, block])).standard_normal((NOISE_ROWS, 5))


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


@kernel
def acquire(taps, noise, card: Card, step: float, out) -> None:
    """Fill `out` (5) with one scan. taps: shape (2, 5), true values a step [s] before the scan's end and at it."""
    channels = 5 if card.tachometer else 4
    turn = 0
    for j in range(5):
        if j == 1 and not card.tachometer:
            out[j] = np.nan
            continue
        earlier = (channels - 1 - turn) * card.skew / step
        value = taps[1, j] + earlier * (taps[0, j] - taps[1, j])
        turn += 1
        if j == 0:
            out[j] = convert(value, 0.0, card.position_range, noise[j], card)
        elif j == 1:
            out[j] = convert(value, -card.velocity_range, card.velocity_range, noise[j], card)
        else:
            out[j] = convert(value, 0.0, card.pressure_range, noise[j], card)
