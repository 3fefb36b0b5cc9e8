"""What was commanded and measured, aligned on the grid: of a log that was imported, and of a recording of ours alike.

For whoever fits a model, watches a rig or compares: `measured(read(path))`.
"""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError
from bridge.recording.imported import facts, is_measured
from bridge.recording.logs.map import COMMAND
from bridge.recording.logs.sensors import Sensor, from_plain
from bridge.recording.reader import Recording
from bridge.recording.unheard import refused, unheard
from bridge.scenario import Scenario
from bridge.scenario.channels import chosen
from bridge.wire.events import ends_telling
from bridge.wire.messages import CHANNELS_TOPIC, EventKind
from controller.grid import NS, to_ns
from twin.topology import CHANNELS

Floats = NDArray[np.float64]
CENTRED = 0.0  # spool reference of a run until its first command acts


class Measured(NamedTuple):
    """Arrays of one length: row k belongs to times[k]. What is missing is NaN."""

    scenario: Scenario  # the drive that the data belong to, its card and its start
    period: float  # of the grid [s]
    times: Floats  # [s]
    command: Floats  # spool reference, -1..1, positive connects P with A: in force from times[k] on
    signals: dict[str, Floats]  # SI: channels of the card and further channels that hold any number
    sensors: dict[str, Sensor]  # noise and quantum of each signal
    simulated: bool  # a run of the twin, and not a rig

    def known(self) -> NDArray[np.bool_]:
        """Rows at which the command and every signal are known."""
        return np.isfinite(self.command) & np.all([np.isfinite(v) for v in self.signals.values()], axis=0)


def measured(recording: Recording) -> Measured:
    """The aligned arrays of a recording. Raises UsageError where it has no measurement or no command."""
    scenario = recording.scenario()
    for topic in ("measurement", COMMAND):
        if not recording.counts.get(topic):
            raise UsageError(f"{recording.path}: holds no {topic}; a recording of both commands and measurements does")
    period = to_ns(scenario.loop.daq_period)
    stamps = recording.columns("measurement")["stamp"]
    grid = np.arange(int(stamps.max()) // period + 1, dtype=np.int64) * period
    signals = {name: values for name, values in _signals(recording, grid, period) if np.isfinite(values).any()}
    given = is_measured(recording)
    command = _at_stamps(recording, grid, period) if given else _in_force(recording, grid)
    sensors = _of_log(recording, signals) if given else _of_card(scenario, signals)
    return Measured(scenario, period / NS, grid / NS, command, signals, sensors, not given)


def _signals(recording: Recording, grid: NDArray[np.int64], period: int) -> Iterator[tuple[str, Floats]]:
    topics = {"measurement": tuple(CHANNELS), CHANNELS_TOPIC: tuple(field.name for field in recording.layout())}
    for topic, names in topics.items():
        if recording.counts.get(topic):
            columns = recording.columns(topic)
            yield from ((name, _on_grid(columns["stamp"], columns[name], grid, period)) for name in names)


def _on_grid(stamps: NDArray[np.int64], values: Floats, grid: NDArray[np.int64], period: int) -> Floats:
    found = np.full(len(grid), np.nan)
    whole = (stamps % period == 0) & (stamps >= 0) & (stamps <= grid[-1])
    found[stamps[whole] // period] = values[whole]
    return found


def _at_stamps(recording: Recording, grid: NDArray[np.int64], period: int) -> Floats:
    sent = recording.columns(COMMAND)
    return _on_grid(sent["sample_stamp"], sent["spool"], grid, period)


def _in_force(recording: Recording, grid: NDArray[np.int64]) -> Floats:
    """What acted at each instant: late commands from when they did, those not taken not, NaN where it is not known.

    That is in a safe state, and once the plant has refused so many that it tells no more of them.
    """
    events = recording.messages("event") if recording.counts.get("event") else []
    commands = recording.messages(COMMAND)
    late = {(e.source, e.command): e.applied_at for e in events if e.kind == EventKind.LATE}
    left_out = refused(events) | unheard(events, commands)
    acts: list[tuple[int, float]] = [(e.applied_at, np.nan) for e in events if e.kind == EventKind.SAFE]
    for command in commands:
        name = command.source, command.sequence
        if name not in left_out:
            acts.append((late.get(name, command.apply_at), command.spool))
    acts.sort(key=lambda act: act[0])
    instants, values = np.array([a for a, _ in acts], np.int64), np.array([v for _, v in acts], np.float64)
    last = np.searchsorted(instants, grid, side="right") - 1
    known = grid < min((e.stamp for e in events if ends_telling(e)), default=grid[-1] + 1)
    return np.where(known, np.where(last < 0, CENTRED, values[np.maximum(last, 0)]), np.nan)


def _of_log(recording: Recording, signals: Mapping[str, Floats]) -> dict[str, Sensor]:
    told: Mapping[str, Any] = facts(recording).get("signals", {})
    return {name: from_plain(told.get(name, {})) for name in signals}


def _of_card(scenario: Scenario, signals: Mapping[str, Floats]) -> dict[str, Sensor]:
    """As the scenario states the card."""
    daq, further = scenario.daq, chosen(scenario)
    found = {}
    for name in signals:
        channel = further.get(name) or CHANNELS[name]
        span = float(getattr(daq, channel.span)) if channel.span else 1.0
        lsb = (2.0 if channel.signed else 1.0) * span / 2.0**daq.bits
        ends = (-span if channel.signed else 0.0, span) if daq.clip else (-np.inf, np.inf)
        found[name] = Sensor(daq.noise * lsb, lsb if daq.quantise else 0.0, True, *ends)
    return found
