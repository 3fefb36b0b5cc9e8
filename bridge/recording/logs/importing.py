"""A log and its map made into a recording: measured, without a true state."""

import hashlib
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bridge.errors import UsageError
from bridge.machine.host import host, versions
from bridge.recording.imported import FACTS, MEASURED
from bridge.recording.logs.carried import Carried, Log, log_of
from bridge.recording.logs.drive import base_of, period_of, scenario_of, units_of
from bridge.recording.logs.formats import read_log
from bridge.recording.logs.map import COMMAND, REFERENCE, Map, load_map
from bridge.recording.logs.packed import name_of
from bridge.recording.logs.remarks import remarks_on
from bridge.recording.logs.sensors import estimated, plain, sensor_of
from bridge.recording.logs.table import Table
from bridge.recording.made_before import is_replaced, save_whole
from bridge.recording.reader import Recording, recording
from bridge.recording.summarise import summarise
from bridge.recording.writer import entries_of
from bridge.scenario import Scenario
from bridge.wire.codec import Channels, Event, Measurement, Reference, Signals, ValveCommand
from bridge.wire.events import last_words
from bridge.wire.messages import CHANNELS_TOPIC, Ending, EventKind, Outgoing
from controller.grid import to_ns
from twin.topology import CHANNELS

FULL = 1.0  # spool reference at the end of the valve's travel
SLACK = 1e-3  # of it: a command beyond the end by less counts as the end
NEVER = {"apply_at": 0, "applied_at": 0, "command": 0, "source": 0}


class Made(NamedTuple):
    """An imported log."""

    recording: Recording
    log: Log
    scenario: Scenario
    replaced: bool = False  # a recording that was imported before

    def ends(self, name: str) -> tuple[float, float]:
        """The least and the greatest value of a signal or an extra column, SI."""
        values = (self.log.signals.get(name) or self.log.extras[name]).values
        return float(np.nanmin(values)), float(np.nanmax(values))


def import_log(path: Path, map_path: Path, output: Path) -> Made:
    """Read a log by a map and write the recording. Raises UsageError with one sentence for what cannot be."""
    if output.resolve() in (path.resolve(), map_path.resolve()):
        raise UsageError(f"{output}: would be overwritten; name another file with --output")
    replaced = is_replaced(output, FACTS, "import")
    made = imported(path, load_map(map_path), map_path)
    save_whole(made.recording, output, made.scenario.rig_name)
    return made._replace(recording=made.recording._replace(path=output), replaced=replaced)


def imported(path: Path, mapped: Map, map_path: Path) -> Made:
    """The recording of a log, in memory. map_path: where the map is from; files it names lie beside it."""
    who, base = map_path.name, base_of(mapped, map_path.parent)
    table = read_log(path, mapped.log)
    units, period = units_of(mapped, base, who), period_of(mapped, base)
    log = log_of(table, mapped, units, period, f"{name_of(path)}: {who}")
    log = log._replace(signals=_within_travel(log.signals, who))
    scenario = scenario_of(mapped, base, log, period, stem(path))
    digest = digest_of(path)
    run_id = int.from_bytes(hashlib.blake2b(f"{digest}/{mapped!r}".encode(), digest_size=8).digest(), "little")
    entries = [entry for messages in _ticks(log, scenario, run_id, name_of(path)) for entry in entries_of(messages)]
    head = {
        "run_id": str(run_id),
        "mode": MEASURED,
        "speed": 0.0,
        "scenario": scenario.model_dump(mode="json"),
        "versions": versions(),
        "host": host(),
        "recorded": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
    }
    facts = _facts(path, digest, table, mapped, map_path, log, units)
    found = recording(path, entries, {"run": head, FACTS: facts})
    summary = summarise(found, scenario, {}).plain()
    return Made(found._replace(metadata={**found.metadata, "summary": summary}), log, scenario)


def stem(path: Path) -> str:
    """A log's name without its endings."""
    name = name_of(path)
    while (shorter := Path(name).stem) != name:
        name = shorter
    return name


def digest_of(path: Path) -> str:
    """SHA-256 of a file; of a folder that of its files' names and bytes, in the order of the names."""
    total = hashlib.sha256()
    for part in [path] if path.is_file() else sorted(file for file in path.rglob("*") if file.is_file()):
        if part != path:
            total.update(str(part.relative_to(path)).encode())
        with part.open("rb") as file:
            while piece := file.read(1 << 20):
                total.update(piece)
    return total.hexdigest()


def _within_travel(signals: Mapping[str, Carried], who: str) -> dict[str, Carried]:
    """Commands within the valve's travel. Raises UsageError for what is a command in other units."""
    found = dict(signals)
    if (command := found.get(COMMAND)) is not None:
        most = float(np.nanmax(np.abs(command.values)))
        if most > FULL + SLACK:
            raise UsageError(
                f"{who}: signal.command reaches {most:g}; 1 is the valve's whole travel: say `scale`, travel per "
                f"{command.taken_in or 'count'}, such as 0.1 of a valve of 10 V"
            )
        found[COMMAND] = command._replace(values=np.clip(command.values, -FULL, FULL))
    return found


def _ticks(log: Log, scenario: Scenario, run_id: int, source: str) -> Iterator[list[Outgoing]]:
    """The messages of each instant of the grid."""
    period = to_ns(scenario.loop.daq_period)
    columns = {name: carried.values.tolist() for name, carried in log.signals.items()}
    extras = {name: carried.values.tolist() for name, carried in log.extras.items()}
    makers = [_measurement(columns, run_id), *_further(columns, scenario, run_id)]
    makers += [_commands(columns, run_id)] if COMMAND in columns else []
    makers += [_references(columns, run_id)] if REFERENCE in columns else []
    makers += [_own(extras, log, run_id)] if extras else []
    last = len(log.grid) - 1
    for tick in range(last + 1):
        stamp = tick * period
        found = [message for make in makers if (message := make(tick, stamp)) is not None]
        found += [_event(run_id, 0, stamp, EventKind.STARTED, f"measured: {source}")] if tick == 0 else []
        found += [_event(run_id, 1, stamp, EventKind.ENDED, last_words(Ending.COMPLETE, last))] if tick == last else []
        yield found


def _measurement(columns: Mapping[str, list[float]], run_id: int):
    missing = [float("nan")] * max(map(len, columns.values()))
    read = [columns.get(name, missing) for name in CHANNELS]

    def make(tick: int, stamp: int) -> Outgoing:
        values = {name: values[tick] for name, values in zip(CHANNELS, read, strict=True)}
        message = Measurement(run_id=run_id, sequence=tick, tick=tick, stamp=stamp, **values)
        return Outgoing("measurement", stamp, tick, message)

    return make


def _further(columns: Mapping[str, list[float]], scenario: Scenario, run_id: int):
    read = [columns[name] for name in scenario.daq.channels if name in columns]

    def make(tick: int, stamp: int) -> Outgoing:
        message = Channels(run_id, tick, tick, stamp, tuple(values[tick] for values in read))
        return Outgoing(CHANNELS_TOPIC, stamp, tick, message)

    return [make] if read else []


def _commands(columns: Mapping[str, list[float]], run_id: int):
    """One command at each instant at which it is known; it acts at once and holds until the next."""
    spools, sent = columns[COMMAND], iter(range(len(columns[COMMAND])))

    def make(tick: int, stamp: int) -> Outgoing | None:
        if (spool := spools[tick]) != spool:
            return None
        number = next(sent)
        head = {"run_id": run_id, "source": run_id, "sequence": number}
        return Outgoing("command", stamp, number, ValveCommand(**head, sample_stamp=stamp, apply_at=stamp, spool=spool))

    return make


def _references(columns: Mapping[str, list[float]], run_id: int):
    def make(tick: int, stamp: int) -> Outgoing:
        head = {"run_id": run_id, "source": run_id, "sequence": tick, "stamp": stamp}
        message = Reference(**head, position=columns[REFERENCE][tick], velocity=float("nan"))
        return Outgoing("reference", stamp, tick, message)

    return make


def _own(extras: Mapping[str, list[float]], log: Log, run_id: int):
    names, units = list(extras), [log.extras[name].unit for name in extras]

    def make(tick: int, stamp: int) -> Outgoing:
        values = np.array([extras[name][tick] for name in names])
        head = {"run_id": run_id, "source": run_id, "sequence": tick, "stamp": stamp}
        return Outgoing("signals", stamp, tick, Signals(**head, names=names, units=units, values=values))

    return make


def _event(run_id: int, number: int, stamp: int, kind: EventKind, text: str) -> Outgoing:
    return Outgoing(
        "event", stamp, number, Event(run_id=run_id, sequence=number, stamp=stamp, kind=kind, text=text, **NEVER)
    )


def _facts(
    path: Path, digest: str, table: Table, mapped: Map, map_path: Path, log: Log, units: Mapping[str, str]
) -> dict[str, Any]:
    """What a recording says of the log that it is from."""
    clock = log.clock
    sensors = {
        name: sensor_of(mapped.signal[name], units[name], carried.values, f"{map_path.name}: {name}")
        for name, carried in log.signals.items()
    }
    return {
        "source": name_of(path),
        "sha256": digest,
        "form": table.form,
        "map": map_path.name,
        "mapped": mapped.model_dump(mode="json", exclude_defaults=True),
        "rows": {
            "read": len(clock.seconds) + clock.duplicates + clock.untimed,
            "duplicate": clock.duplicates,
            "out of order": clock.moved,
            "without a time": clock.untimed,
            "counter began again": clock.wraps,
        },
        "time": {"first": clock.origin, "interval": log.interval, "jitter": log.jitter, "period": float(log.grid[1])},
        "signals": {
            name: _signal(carried) | ({} if name == COMMAND else plain(sensors.get(name) or estimated(carried.values)))
            for name, carried in (*log.signals.items(), *log.extras.items())
        },
        "notes": [*table.notes, *remarks_on(log, mapped)],
    }


def _signal(carried: Carried) -> dict[str, Any]:
    return {
        "column": carried.column,
        "taken in": carried.taken_in,
        "unit": carried.unit,
        "method": str(carried.method),
        "gap": carried.gap,
        "empty": carried.empty,
        "missing": carried.missing,
        "holes": [list(hole) for hole in carried.holes],
    }
