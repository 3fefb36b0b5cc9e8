"""Two recordings side by side: of every signal the greatest difference, its rms, where it begins, and a verdict."""

from collections.abc import Mapping
from fnmatch import fnmatchcase
from typing import NamedTuple

import numpy as np

from bridge.errors import UsageError, nearest
from bridge.recording.imported import is_measured
from bridge.recording.reader import Recording
from bridge.recording.signals import COMPARED, Signal, signals_of
from bridge.scenario.units import UNITS, quantity
from controller.grid import NS


class Difference(NamedTuple):
    """One signal of one file less that of another, at the instants that both have."""

    signal: str
    unit: str
    instants: int  # that both have
    alone: int  # that only one of them has
    greatest: float
    at: float | None  # [s] of the greatest
    rms: float
    first: float | None  # [s] of the first difference beyond the tolerance; None where there is none
    tolerance: float
    passed: bool


def compare(
    mine: Recording,
    other: Recording,
    tolerances: Mapping[str, str] | None = None,
    topics: tuple[str, ...] = COMPARED,
    partly: bool = False,
) -> list[Difference]:
    """Every signal that either has. `partly`: instants that only one has are not a fault.

    tolerances: pattern of signals -> "0.1 mm"; without one nothing may differ. Raises UsageError for wrong ones.
    """
    mine_of, other_of = _known(mine, topics), _known(other, topics)
    names = list(dict.fromkeys((*mine_of, *other_of)))
    if is_measured(mine) != is_measured(other):  # a rig has no true state, nor a sensor everywhere
        names = [name for name in names if name in mine_of and name in other_of]
    if not names:
        raise UsageError(f"{mine.path}, {other.path}: there is no signal in them to compare")
    allowed = _allowed(tolerances or {}, {name: (mine_of.get(name) or other_of[name]).unit for name in names})
    return [difference(name, mine_of.get(name), other_of.get(name), allowed[name], partly) for name in names]


def _known(recording: Recording, topics: tuple[str, ...]) -> dict[str, Signal]:
    """The signals of a recording; of a measured one those with a value, and these without what is missing."""
    found = signals_of(recording, topics)
    if not is_measured(recording):
        return found
    kept = {name: without_missing(signal) for name, signal in found.items()}
    return {name: signal for name, signal in kept.items() if len(signal.stamp)}


def without_missing(signal: Signal) -> Signal:
    """A signal that was measured, without the instants at which it is not known."""
    rows = np.isfinite(signal.value)
    return signal._replace(stamp=signal.stamp[rows], value=signal.value[rows])


def difference(name: str, mine: Signal | None, other: Signal | None, tolerance: float, partly: bool) -> Difference:
    """How one signal differs; NaN is the same as NaN, and as nothing else."""
    if mine is None or other is None:
        found = mine or other
        assert found is not None
        return Difference(name, found.unit, 0, len(found.stamp), np.nan, None, np.nan, None, tolerance, partly)
    stamps, at_mine, at_other = np.intersect1d(mine.stamp, other.stamp, return_indices=True)
    alone = len(np.union1d(mine.stamp, other.stamp)) - len(stamps)
    if not len(stamps):
        return Difference(name, mine.unit, 0, alone, np.nan, None, np.nan, None, tolerance, partly)
    apart = _apart(mine.value[at_mine], other.value[at_other])
    most, beyond = int(np.argmax(apart)), np.flatnonzero(apart > tolerance)
    first = float(stamps[beyond[0]]) / NS if len(beyond) else None
    rms = float(np.sqrt(np.mean(np.square(apart))))
    passed = first is None and (partly or not alone)
    at = float(stamps[most]) / NS if apart[most] > 0.0 else None
    return Difference(name, mine.unit, len(stamps), alone, float(apart[most]), at, rms, first, tolerance, passed)


def _apart(mine: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Absolute differences; infinite where only one is a number."""
    with np.errstate(invalid="ignore"):
        apart = np.abs(mine - other)
    same = (np.isnan(mine) & np.isnan(other)) | (mine == other)
    return np.where(same, 0.0, np.where(np.isnan(apart), np.inf, apart))


def _allowed(tolerances: Mapping[str, str], unit_of: dict[str, str]) -> dict[str, float]:
    allowed = dict.fromkeys(unit_of, 0.0)
    for pattern, text in tolerances.items():
        names = [n for n in unit_of if fnmatchcase(n, pattern) or fnmatchcase(n.partition(".")[2], pattern)]
        if not names:
            raise UsageError(f"--tolerance {pattern}: no such signal{nearest(pattern, unit_of)}")
        for name in names:
            try:
                allowed[name] = quantity(text, unit_of[name] if unit_of[name] in UNITS else "")
            except ValueError as error:
                raise UsageError(f"--tolerance {pattern}={text}: {name}: {error}") from None
    return allowed
