"""Transducers that lie: what reaches the card in place of the true values.

A fault acts on a channel after all that stand before it in the scenario. A scan is one point of time: what the card
interpolates inside a step is changed by the same rule.
"""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.loop.fault_chance import Luck
from bridge.loop.fault_clock import Spell
from bridge.loop.spells import Spells
from controller.course import NEVER
from controller.grid import NS

Array = NDArray[np.float64]


class Moment(NamedTuple):
    """A scan."""

    tick: int
    now: int  # [ns]
    true: Array  # true values, a row per point of time, a column per channel


class Input(NamedTuple):
    """A channel of the card."""

    column: int
    low: float  # ends of its range, SI
    high: float


Lie = Callable[[Array, Moment], Array]  # of a channel's values at one or two points of time


class SensorFaults:
    """Faults of the channels of one card."""

    def __init__(self, inputs: Mapping[str, Input], seed: int, daq: int) -> None:
        self._inputs = inputs
        self._seed = seed
        self._daq = daq
        self._spells: Spells[Lie] = Spells()

    def start(self, spell: Spell) -> None:
        """A fault of a channel is going to be there."""
        lie = KINDS[spell.fault.kind](spell, Luck(self._seed, f"{spell.fault.name} scan"), self)
        self._spells.add(spell, lie, early=spell.fault.kind in REMEMBERING)

    def end(self, name: str, now: int) -> None:
        """End a fault of a channel at an instant [ns]."""
        self._spells.end(name, now)

    def read(self, tick: int, now: int, true: Array) -> Array:
        """What reaches the card of true values; shape (points of time, channels), or (channels,)."""
        read = np.atleast_2d(true).copy()
        moment = Moment(tick, now, np.atleast_2d(true))
        for spell, lie in self._spells.near(now):
            column = self._inputs[spell.fault.part].column
            told = lie(read[:, column], moment)
            if spell.begin <= now:
                read[:, column] = told
        return read.reshape(true.shape)

    def input(self, name: str) -> Input:
        """A channel by its name."""
        return self._inputs[name]

    @property
    def daq(self) -> int:
        """From scan to scan [ns]."""
        return self._daq


REMEMBERING = ("delay",)  # kinds that have to see the scans before they begin
Maker = Callable[[Spell, Luck, SensorFaults], Lie]


def _off(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    return lambda values, moment: np.zeros_like(values)


def _stuck(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    kept: list[float] = []

    def lie(values: Array, moment: Moment) -> Array:
        if not kept:
            kept.append(float(values[-1]))
        return np.full_like(values, kept[0])

    return lie


def _bias(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    size = spell.fault.sizes["size"]
    return lambda values, moment: values + size


def _drift(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    rate = spell.fault.sizes["rate"]
    return lambda values, moment: values + rate * ((moment.now - spell.begin) / NS)


def _gain(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    factor = spell.fault.sizes["factor"]
    return lambda values, moment: values * factor


def _noise(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    size = spell.fault.sizes["size"]
    return lambda values, moment: values + size * luck.normal(moment.tick)


def _spikes(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    size, share = spell.fault.sizes["size"], spell.fault.sizes["share"]
    return lambda values, moment: values + size * (luck.uniform(moment.tick) < share)


def _quantisation(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    size = spell.fault.sizes["size"]
    return lambda values, moment: size * np.floor(values / size + 0.5)


def _saturation(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    low, high = spell.fault.sizes["low"], spell.fault.sizes["high"]
    return lambda values, moment: np.minimum(np.maximum(values, low), high)


def _wrong_channel(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    own, other = card.input(spell.fault.part), card.input(spell.fault.word)
    scale = (own.high - own.low) / (other.high - other.low)
    return lambda values, moment: own.low + scale * (moment.true[:, other.column] - other.low)


def _delay(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    ticks = round(spell.fault.sizes["time"] * NS / card.daq)
    seen: deque[Array] = deque(maxlen=ticks + 1)

    def lie(values: Array, moment: Moment) -> Array:
        seen.append(values.copy())
        return seen[0]

    return lie


def _intermittent(spell: Spell, luck: Luck, card: SensorFaults) -> Lie:
    share, length = spell.fault.sizes["share"], spell.fault.sizes["length"]
    end = 1e6 if spell.end == NEVER else (spell.end - spell.begin) / NS
    spells, now = luck.spells(spell.number, share, length, end), [(0.0, 0.0)]

    def lie(values: Array, moment: Moment) -> Array:
        since = (moment.now - spell.begin) / NS
        while since >= now[0][1]:
            now[0] = next(spells, (np.inf, np.inf))
        return np.zeros_like(values) if since >= now[0][0] else values

    return lie


KINDS: dict[str, Maker] = {
    "off": _off,
    "stuck": _stuck,
    "bias": _bias,
    "drift": _drift,
    "gain": _gain,
    "noise": _noise,
    "spikes": _spikes,
    "quantisation": _quantisation,
    "saturation": _saturation,
    "wrong-channel": _wrong_channel,
    "delay": _delay,
    "intermittent": _intermittent,
}


def inputs_of(names: Sequence[str], ends: Mapping[str, tuple[float, float]]) -> dict[str, Input]:
    """The channels of a card in their order; ends: of their ranges."""
    return {name: Input(column, *ends[name]) for column, name in enumerate(names)}
