"""A log of another rig as a record for a fit: its commands act from sample to sample."""

from typing import NamedTuple

import numpy as np

from bridge.errors import UsageError
from bridge.recording.logs.measured import Floats, measured
from bridge.recording.logs.sensors import Sensor
from bridge.recording.reader import Recording
from bridge.studies.identification.data import TAPS, Measured, Record, held, least, uncompared
from bridge.studies.identification.noise import counted, deviation_of
from controller.grid import NS
from twin.topology import CHANNELS, OBSERVED

POSITION = "position"


class Taken(NamedTuple):
    """A signal of a log, or why it is left out."""

    signal: Measured | None
    notes: tuple[str, ...]


def imported_record(recording: Recording, name: str) -> Record:
    """The record, from where command and position are known until the first command that is missing.

    Raises UsageError where that leaves too little.
    """
    found = measured(recording)
    grid = found.scenario.loop.grid()
    begin, end = _stretch(found.command, found.signals.get(POSITION))
    period = grid.daq / NS
    if end - begin < (fewest := least(period)):
        raise UsageError(
            f"{recording.path}: {end - begin} samples from where command and position are known to the next gap in "
            f"the commands; a fit needs {fewest}, which are {fewest * period:g} s"
        )
    stretches, first = held(found.command[begin:end], grid.daq // grid.step)
    notes = [f"from {found.times[begin]:g} s, where command and position are both known"] if begin else []
    notes += [f"until {found.times[end]:g} s, where a command is missing"] if end < len(found.command) else []
    used = {quantity: values for quantity, values in found.signals.items() if quantity in (*TAPS, *OBSERVED)}
    taken = {quantity: _taken(quantity, v[begin:end], found.sensors[quantity]) for quantity, v in used.items()}
    if POSITION in taken and taken[POSITION].signal is None:
        raise UsageError(f"{recording.path}: {taken[POSITION].notes[0]}; a fit needs a rod that moves")
    signals = tuple(one.signal for one in taken.values() if one.signal is not None)
    notes += [note for one in taken.values() for note in one.notes]
    return Record(name, period, grid.step / NS, stretches, first, signals, tuple(notes))


def _stretch(command: Floats, position: Floats | None) -> tuple[int, int]:
    """The first sample at which command and position are known, and the next without a command; equal where none is."""
    known = np.isfinite(command)
    both = known if position is None else known & np.isfinite(position)
    if not both.any():
        return 0, 0
    begin = int(np.argmax(both))
    gaps = np.flatnonzero(~known[begin:])
    return begin, begin + int(gaps[0]) if len(gaps) else len(command)


def _taken(quantity: str, values: Floats, sensor: Sensor) -> Taken:
    unit = CHANNELS[quantity].unit if quantity in TAPS else OBSERVED[quantity]
    value = np.asarray(values)
    deviation, note = deviation_of(value, sensor.rms, sensor.stated, unit)
    if deviation is None:
        return Taken(None, (f"{quantity} {note}" + ("" if quantity == POSITION else "; it is left out"),))
    part = counted(value, sensor.low, sensor.high - sensor.quantum)
    note = f"{quantity} {note}" if note else ""
    return Taken(Measured(quantity, quantity, unit, value, deviation, part, note=note), uncompared(quantity, part))
