"""A log of another rig as a record for a fit: its commands act from sample to sample."""

from collections.abc import Iterator

import numpy as np

from bridge.errors import UsageError
from bridge.recording.logs.measured import measured
from bridge.recording.reader import Recording
from bridge.scenario import Scenario
from bridge.scenario.channels import known
from bridge.studies.identification.data import TAPS, Measured, Record, held
from bridge.studies.identification.noise import counted, estimated
from controller.grid import NS
from twin.topology import CHANNELS, OBSERVED

LEAST = 1000  # samples of a record


def imported_record(recording: Recording, name: str) -> Record:
    """The record, until the first command that is missing. Raises UsageError where that leaves too little."""
    found = measured(recording)
    grid = found.scenario.loop.grid()
    gap = np.flatnonzero(~np.isfinite(found.command))
    begin = int(np.argmax(np.isfinite(found.command)))
    later = gap[gap > begin]
    end = int(later[0]) if len(later) else len(found.command)
    if end - begin < LEAST:
        raise UsageError(f"{recording.path}: {end - begin} samples without a gap in the commands; a fit needs {LEAST}")
    stretches, first = held(found.command[begin:end], grid.daq // grid.step)
    notes = () if end == len(found.command) else (f"until {found.times[end]:g} s, where a command is missing",)
    signals = []
    for quantity, values in found.signals.items():
        if quantity in TAPS or quantity in OBSERVED:
            value, sensor = np.asarray(values[begin:end]), found.sensors[quantity]
            deviation = sensor.rms or estimated(value)
            unit = CHANNELS[quantity].unit if quantity in TAPS else OBSERVED[quantity]
            low, high = next(_ends(quantity, found.scenario))
            part = counted(value, low, high - (sensor.quantum or 0.0))
            signals.append(Measured(quantity, quantity, unit, value, deviation, part))
    return Record(name, grid.daq / NS, grid.step / NS, stretches, first, tuple(signals), notes)


def _ends(quantity: str, scenario: Scenario) -> Iterator[tuple[float, float]]:
    """The range of a sensor [SI]."""
    if quantity in TAPS:
        span = float(getattr(scenario.daq, CHANNELS[quantity].span))
        yield (-span if CHANNELS[quantity].signed else 0.0), span
    yield known(scenario)[quantity].ends(scenario.daq)
