"""Measuring amplifiers between transducers and card: a first-order lag each, exact for a signal that is straight
within a step; fitted or not, which is known when a step is compiled.

Source: 2.2.2 names the amplifier, not its filter.
"""

import math
from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.kernel import by_type
from twin.lag import Lag, follow, lag_over


class Direct(NamedTuple):
    """The card reads the transducers themselves."""


class Amplifiers(NamedTuple):
    """One of each kind of transducer."""

    position: Lag
    pressure: Lag


def lag(bandwidth: float, step: float) -> Lag:
    """The lag with a bandwidth [Hz] (-3 dB) over a step [s]."""
    return lag_over(1.0 / (2.0 * math.pi * bandwidth * step))


@by_type
def is_amplified(amplifiers: Any) -> bool:
    """Does the card read amplifiers?"""
    raise TypeError(f"{amplifiers} are not amplifiers")


@is_amplified.register
def _(amplifiers: Direct) -> bool:
    return False


@is_amplified.register
def _(amplifiers: Amplifiers) -> bool:
    return True


@by_type
def amplify(amplifiers: Any, position: float, pressure: NDArray, taps: NDArray, signals: NDArray) -> None:
    """Move the signals on by a step: the outputs, then the inputs; of each the position, then the pressures.

    pressure: of all line ends; taps: which of them have a transducer.
    """
    raise TypeError(f"{amplifiers} are not amplifiers")


@amplify.register
def _(amplifiers: Direct, position: float, pressure: NDArray, taps: NDArray, signals: NDArray) -> None:
    pass


@amplify.register
def _(amplifiers: Amplifiers, position: float, pressure: NDArray, taps: NDArray, signals: NDArray) -> None:
    inputs = len(taps) + 1
    signals[0] = follow(signals[0], signals[inputs], position, amplifiers.position)
    signals[inputs] = position
    for i in range(1, inputs):
        p = pressure[int(taps[i - 1])]
        signals[i] = follow(signals[i], signals[inputs + i], p, amplifiers.pressure)
        signals[inputs + i] = p
