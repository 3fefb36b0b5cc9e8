"""A recording of ours as a record for a fit: until something happens that the commands do not explain."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from bridge.errors import UsageError
from bridge.recording.imported import is_measured
from bridge.recording.reader import Recording, read
from bridge.recording.unheard import refused, unheard
from bridge.scenario import Scenario
from bridge.scenario.channels import chosen
from bridge.studies.identification.data import Array, Measured, Record, least, uncompared
from bridge.studies.identification.imported import imported_record
from bridge.studies.identification.noise import counted, stated
from bridge.wire.events import ends_telling
from bridge.wire.messages import CHANNELS_TOPIC, EventKind
from controller.grid import NS
from controller.hold import Hold
from twin.circuit.course import Stretches
from twin.sensors import card_of, put_out
from twin.topology import CHANNELS, OBSERVED

NEEDED = ("measurement", "command", "event", CHANNELS_TOPIC)
CENTRED = 0.0
OTHERWISE = (EventKind.SAFE, EventKind.DEGRADED, EventKind.FAULT)  # what acts then is not what was commanded


def record_of(path: Path) -> Record:
    """The record in a file. Raises UsageError where it holds none that a fit can use."""
    return record_in(read(path, NEEDED))


def record_in(recording: Recording) -> Record:
    """The record in a recording. Raises UsageError as `record_of`."""
    path, scenario = recording.path, recording.scenario()
    if is_measured(recording):
        return imported_record(recording, name_of(path))
    if any(fault.target.startswith("link.") for fault in scenario.fault):
        raise UsageError(f"{path}: a fault of the link is planned in it; record without to identify the rig")
    measurement = recording.columns("measurement")
    grid = scenario.loop.grid()
    last = int(measurement["stamp"].max(initial=0))
    end, why = _end(recording, scenario, last)
    count = end // grid.daq + 1
    period = grid.daq / NS
    if count < (fewest := least(period)):
        raise UsageError(f"{path}: {count} samples{why}; a fit needs {fewest}, which are {fewest * period:g} s")
    stretches, first = _stretches(recording, scenario, count)
    signals = (*_card(measurement, scenario, count), *_further(recording, scenario, count))
    notes = [why.removeprefix(" ")] if why else []
    notes += [note for signal in signals for note in uncompared(signal.name, signal.counted)]
    return Record(name_of(path), period, grid.step / NS, stretches, first, signals, tuple(notes))


def name_of(path: Path) -> str:
    """A recording in a table."""
    return f"{path.absolute().parent.name}/{path.stem}" if path.stem == "run" else path.stem


def _end(recording: Recording, scenario: Scenario, last: int) -> tuple[int, str]:
    """Until when the rig is what it was at the start, and only commands act [ns]; why not to the end."""
    daq = scenario.loop.grid().daq
    for event in sorted(recording.messages("event"), key=lambda event: event.stamp):
        if why := _why(event):
            until = max(0, min(event.stamp, event.apply_at or event.stamp) - daq) // daq * daq
            return until, f" until {until / NS:g} s, where {why}: {event.text}"
    return last, ""


def _why(event: Any) -> str:
    """Why commands do not say what acts after an event; "" where they do."""
    if ends_telling(event):
        return "it is no longer told which commands were refused"
    other = event.kind in OTHERWISE or (event.kind == EventKind.CHANGED and _of_plant(event.text))
    return "something else than commands acts" if other else ""


def _of_plant(changed: str) -> bool:
    """Does the text of a `changed` event name a number of the plant?"""
    return changed.rpartition(": ")[2].startswith(("rig.", "sensor.", "channel."))


def _stretches(recording: Recording, scenario: Scenario, count: int) -> tuple[Stretches, Any]:
    grid, hold = scenario.loop.grid(), Hold(CENTRED)
    for apply_at, spool in _commands(recording):
        hold.put(apply_at, spool)
    found: list[tuple[float, int, int]] = []
    first = [0, 0]
    for sample in range(1, count):
        cut = list(hold.segments((sample - 1) * grid.daq, sample * grid.daq))
        parts = [(_acting(s.value, scenario), (s.end - s.begin) // grid.step) for s in cut if s.end > s.begin]
        found += [(value, steps, -1) for value, steps in parts[:-1]] + [(*parts[-1], sample)]
        first.append(len(found))
    reference, steps, row = zip(*found, strict=True)
    return Stretches(np.array(reference, float), np.array(steps), np.array(row)), np.array(first)


def _commands(recording: Recording) -> Iterator[tuple[int, float]]:
    """When each command that was taken acted [ns], and its spool reference, in the order in which they act."""
    events, commands = recording.messages("event"), recording.messages("command")
    late = {(e.source, e.command): e.applied_at for e in events if e.kind == EventKind.LATE}
    left_out = refused(events) | unheard(events, commands)
    for command in commands:
        name = command.source, command.sequence
        if name not in left_out:
            yield late.get(name, command.apply_at), command.spool


def _acting(reference: float, scenario: Scenario) -> float:
    daq = scenario.daq
    return put_out(reference, daq.output_bits) if daq.quantise_output else reference


def _card(measurement: dict[str, Any], scenario: Scenario, count: int) -> Iterator[Measured]:
    """What the card's own channels have read."""
    card, grid = card_of(scenario.daq), scenario.loop.grid()
    waiting = int(card.fitted.sum())
    for j, (name, channel) in enumerate(CHANNELS.items()):
        if not card.fitted[j]:
            continue
        waiting -= 1
        value = _by_sample(measurement, name, grid.daq, count)
        low, high = float(card.low[j]), float(card.high[j])
        lead = waiting * card.skew / (grid.step / NS)
        yield _measured(name, name, channel.unit, value, (low, high), scenario)._replace(lead=lead)


def _further(recording: Recording, scenario: Scenario, count: int) -> Iterator[Measured]:
    """What the further channels have read of quantities that the twin observes."""
    sensors = chosen(scenario)
    if not any(name in OBSERVED for name in sensors) or not recording.counts.get(CHANNELS_TOPIC):
        return
    columns, daq = recording.columns(CHANNELS_TOPIC), scenario.loop.grid().daq
    known = {channel.reads for channel in CHANNELS.values()}
    for name, sensor in sensors.items():
        if name in OBSERVED and name not in known:
            value = _by_sample(columns, name, daq, count)
            yield _measured(name, name, sensor.unit, value, sensor.ends(scenario.daq), scenario)


def _measured(
    name: str, quantity: str, unit: str, value: Array, ends: tuple[float, float], scenario: Scenario
) -> Measured:
    daq, (low, high) = scenario.daq, ends
    step = (high - low) / 2.0**daq.bits
    limits = (low, high - step) if daq.clip else (-np.inf, np.inf)
    deviation = stated(step, daq.noise, daq.quantise) or 1e-3 * step  # of a card without either
    return Measured(name, quantity, unit, value, deviation, counted(value, *limits))


def _by_sample(columns: dict[str, Any], name: str, daq: int, count: int) -> Array:
    value = np.full(count, np.nan)
    at = columns["stamp"] // daq
    inside = at < count
    value[at[inside]] = columns[name][inside]
    return value


def same_grid(records: list[Record]) -> None:
    """Raises UsageError for records whose samples are not equally far apart."""
    for one, other in pairwise(records):
        if abs(one.period - other.period) > 1e-12:
            raise UsageError(
                f"{other.name} has a sample every {other.period:g} s and {one.name} every {one.period:g} s; "
                "fit recordings of one rate together"
            )
