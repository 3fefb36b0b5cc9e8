"""What a fit is made from: what acted on the valve, and what was measured, sample by sample."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit.course import Stretches
from twin.topology import CHANNELS

Array = NDArray[np.float64]
TAPS = tuple(CHANNELS)
STILL, SETTLING = 2e-3, 0.05  # share of the travel, and time [s] after which a valve that is shut counts as so
MOVED = 10.0  # deviations of the noise in SETTLING: slower is creeping
CHAMBERS = ("p2", "p3", "p_lower", "p_upper")
SHORTEST, FEWEST = 1.0, 200  # [s], and samples, of a record: longer than the run that leads to a start
MOST_TOLD = 0.95  # share of samples that are compared, from which on nothing is said of the others


class Measured(NamedTuple):
    """A signal that was measured."""

    name: str  # as the recording has it
    quantity: str  # what it touches: a channel of the card, behind its amplifier, or an observed quantity
    unit: str  # SI
    value: Array  # by sample; NaN where nothing was read
    deviation: float  # standard deviation of noise and rounding [SI]
    counted: NDArray[np.bool_]  # samples that are compared: read, and not at an end of the range
    lead: float = 0.0  # how much earlier than the sample it is read, in internal steps
    note: str = ""  # on its deviation


class Record(NamedTuple):
    """One recording, on the grid of its samples."""

    name: str
    period: float  # between samples [s]
    step: float  # internal, in which stretches are counted [s]
    stretches: Stretches  # the first sample has none: it is where the record begins
    first: NDArray[np.int64]  # stretch with which each sample begins, and behind the last the number of stretches
    signals: tuple[Measured, ...]
    notes: tuple[str, ...] = ()

    @property
    def told(self) -> list[str]:
        """What whoever reads a result should know of it and its signals."""
        return [*self.notes, *(signal.note for signal in self.signals if signal.note)]

    @property
    def samples(self) -> int:
        """How many there are."""
        return len(self.first) - 1

    @property
    def duration(self) -> float:
        """From the first sample to the last [s]."""
        return (self.samples - 1) * self.period

    def signal(self, quantity: str) -> Measured | None:
        """The signal that touches a quantity."""
        return next((signal for signal in self.signals if signal.quantity == quantity), None)

    def between(self, begin: int, end: int) -> Stretches:
        """What acts from a sample to another, its rows counted from 0."""
        part = slice(self.first[begin + 1], self.first[end + 1])
        reference, steps, row = self.stretches.reference[part], self.stretches.steps[part], self.stretches.row[part]
        return Stretches(reference.copy(), steps.copy(), np.where(row < 0, row, row - begin - 1))


def least(period: float) -> int:
    """How many samples a record needs."""
    return max(FEWEST, round(SHORTEST / period))


def uncompared(name: str, counted: NDArray[np.bool_]) -> tuple[str, ...]:
    """What is said of a signal of which many samples are not compared."""
    if counted.mean() > MOST_TOLD:
        return ()
    return (
        f"{counted.sum()} of {len(counted)} samples of {name} are compared: the others are missing, or within some "
        "samples of an end of the sensor's range",
    )


def held(references: Array, steps: int) -> tuple[Stretches, NDArray[np.int64]]:
    """Stretches of references that each act from their sample to the next, and where samples begin."""
    count = len(references)
    rows = np.arange(1, count)
    return Stretches(references[:-1].copy(), np.full(count - 1, steps), rows), np.array([0, *range(count)])


def in_steps(record: Record, step: float) -> Record:
    """The record, counted in another step [s]. Raises ValueError where a stretch is not a whole number of these."""
    share = record.step / step
    steps = record.stretches.steps * share
    if np.abs(steps - steps.round()).max() > 1e-6:
        raise ValueError(f"loop.step {step:g} s: commands of {record.name} act at multiples of {record.step:g} s")
    signals = tuple(signal._replace(lead=signal.lead * share) for signal in record.signals)
    stretches = record.stretches._replace(steps=steps.round().astype(np.int64))
    return record._replace(step=step, stretches=stretches, signals=signals)


def only_moving(record: Record) -> Record:
    """The record, its chambers' pressures counted only while a command opens the valve, or has just shut it, and the
    rod moves.

    At rest they hang on a micrometre of the spool; where it creeps, on when it sticks.
    """
    reference = np.abs(record.stretches.reference[record.first[1:] - 1])
    reach = max(1, round(SETTLING / record.period))
    open_ = np.convolve(reference > STILL, np.ones(reach), "full")[: record.samples] > 0.5
    moving = open_ & _moves(record, reach)
    signals = [s._replace(counted=s.counted & moving) if s.quantity in CHAMBERS else s for s in record.signals]
    return record._replace(signals=tuple(signals))


def _moves(record: Record, reach: int) -> NDArray[np.bool_]:
    """Where the rod, the mean of `reach` samples, goes further than MOVED in that time."""
    signal = record.signal("position")
    if signal is None:
        return np.ones(record.samples, bool)
    missing = ~np.isfinite(signal.value)
    held = np.interp(np.arange(record.samples), np.flatnonzero(~missing), signal.value[~missing])
    padded = np.pad(held, reach, mode="edge")
    mean = np.convolve(padded, np.ones(reach) / reach, "valid")
    moved = np.abs(mean[reach : reach + record.samples] - mean[: record.samples])
    return moved > MOVED * signal.deviation


def with_noise(record: Record, deviations: Mapping[str, tuple[float, str]]) -> Record:
    """The record with other deviations of the noise [SI] and notes on them, by signal."""
    others = {name: {"deviation": value, "note": note} for name, (value, note) in deviations.items()}
    return record._replace(signals=tuple(s._replace(**others.get(s.name, {})) for s in record.signals))
