"""What is left until a sampled loop oscillates: critical gains, delay margin, and gains that keep a distance."""

import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from bridge.stability.loop import NEUTRAL, Loop, Onset, Timing, excess, onset, sampled, stable
from bridge.stability.plant import Plant

LOWEST, HIGHEST, TRIED = 1e-2, 1e5, 200  # gains [1/m] that are looked at, 8 % apart
LATEST = 5.0  # sampling periods, the longest further delay that is looked at
DELAYS = 200
DERIVATIVES = 400
GAIN_MARGIN = 2.0  # of suggested gains
DELAY_MARGIN = 1.0  # of suggested gains, in sampling periods


class Margins(NamedTuple):
    """Of one loop at its gains."""

    critical: Onset  # by the proportional gain [1/m]
    derivative_low: float  # [s/m], the stretch of derivative gains around the own one that is stable; NaN if it is not
    derivative_high: float
    gain_margin: float  # critical over own gain
    delay_margin: float  # [s], further delay that the own gains bear; inf beyond LATEST periods


def critical_gain(loop: Loop, derivative: float) -> Onset:
    """The smallest gain at which the loop loses stability: 0.0 if the smallest is unstable, inf if none is found."""
    gains = np.geomspace(LOWEST, HIGHEST, TRIED)
    bad = np.flatnonzero(excess(loop, gains, derivative) > NEUTRAL)
    if not len(bad):
        return Onset(math.inf, "none", 0.0)
    if bad[0] == 0:
        return Onset(0.0, *onset(loop, LOWEST, derivative))
    low, high = (float(gain) for gain in gains[bad[0] - 1 : bad[0] + 1])
    gain = edge(lambda g: stable(loop, g, derivative), low, high)
    return Onset(gain, *onset(loop, gain, derivative))


def edge(good: Callable[[float], bool], inside: float, outside: float) -> float:
    """Where a loop that is good inside stops to be so, to 1e-9 of the stretch."""
    for _ in range(30):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if good(middle) else (inside, middle)
    return 0.5 * (inside + outside)


def derivative_range(loop: Loop, gain: float, derivative: float) -> tuple[float, float]:
    """The stable stretch of derivative gains [s/m] around the own one, from 0 up; NaN, NaN if that is unstable."""
    if not stable(loop, gain, derivative):
        return math.nan, math.nan
    span = np.linspace(0.0, max(4.0 * derivative, 2.0 * gain * max(loop.period, 0.05)), DERIVATIVES)
    bad = span[excess(loop, gain, span) > NEUTRAL]
    below, above = bad[bad < derivative], bad[bad > derivative]
    low = edge(lambda d: stable(loop, gain, d), derivative, float(below[-1])) if len(below) else 0.0
    high = edge(lambda d: stable(loop, gain, d), derivative, float(above[0])) if len(above) else math.inf
    return low, high


def delay_margin(plant: Plant, timing: Timing, gain: float, derivative: float) -> float:
    """The further delay [s] at which the loop loses stability; 0.0 if it is unstable, inf beyond LATEST periods."""

    def good(further: float) -> bool:
        return stable(sampled(plant, timing._replace(delay=timing.delay + further)), gain, derivative)

    if not good(0.0):
        return 0.0
    tried = np.linspace(0.0, LATEST * timing.period, DELAYS).tolist()
    for before, after in pairwise(tried):
        if not good(after):
            return edge(good, before, after)
    return math.inf


def margins(plant: Plant, timing: Timing, gain: float, derivative: float) -> Margins:
    """All of them for a plant at the gains [1/m], [s/m] of its controller."""
    loop = sampled(plant, timing)
    critical = critical_gain(loop, derivative)
    late = delay_margin(plant, timing, gain, derivative)
    ratio = critical.gain / gain if gain > 0.0 else math.inf
    return Margins(critical, *derivative_range(loop, gain, derivative), ratio, late)


def suggested_gain(plants: Mapping[str, Plant], timing: Timing, derivative: float) -> float:
    """A gain [1/m] with GAIN_MARGIN and DELAY_MARGIN at every point: half the least critical one, or less; 0.0: none"""
    least = min(critical_gain(sampled(plant, timing), derivative).gain for plant in plants.values())
    gain = least / GAIN_MARGIN
    if not 0.0 < gain < math.inf:
        return 0.0
    late = timing._replace(delay=timing.delay + DELAY_MARGIN * timing.period)
    while not all(stable(sampled(plant, late), gain, derivative) for plant in plants.values()):
        gain *= 0.95
        if gain < 1e-2 * least:
            return 0.0
    return gain
