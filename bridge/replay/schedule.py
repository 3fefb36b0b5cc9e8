"""When each recorded command reached the plant, as far as that can make a difference.

One in time may be handed in as soon as its sample is taken: it acts at its own instant. One that came late is handed in
at the instant it took effect, `applied_at` of its event. What the plant never heard is left out.

A refusal is told again by its event and not judged again: it changes nothing of the plant but what waits for it, and
where a reset or another command came within the same tick nobody knows which was first. A bad link is there again, and
refuses by itself what comes twice or too late: there every command is handed in.
"""

import json
from collections.abc import Iterator
from typing import Any, NamedTuple

from bridge.recording.reader import Recording
from bridge.recording.unheard import refused, unheard
from bridge.replay.stamps import stamp_in
from bridge.scenario import Scenario
from bridge.scenario.faults import LINKS
from bridge.wire.events import injected, is_injection, is_setting, setting_of, withdrawn
from bridge.wire.messages import EventKind
from controller.grid import Sampling, to_ns


class Input(NamedTuple):
    """Something to hand in once the plant has reached an instant [ns]."""

    instant: int
    command: Any  # None: a reset, a setting or a fault
    setting: tuple[str, float, int] | None = None  # name, number and time [ns] that somebody has set
    fault: str = ""  # that somebody has injected, as JSON
    ended: str = ""  # fault that somebody has ended
    refused: Any = None  # event of a refusal


class Latch(NamedTuple):
    """A time in the safe state [ns]: commands that were to act after `since` came when it was in force.

    sampled: and answer a sample from then on, where those before were heard in time.
    """

    since: int
    until: int
    sampled: int = 0


def schedule(recording: Recording, scenario: Scenario) -> list[Input]:
    """All inputs of a recorded run in the order of their instants."""
    events, grid = recording.messages("event"), scenario.loop.grid()
    commands = recording.messages("command")
    linked = _has_bad_link(events, scenario)
    left_out = unheard(events, commands) | (set() if linked else refused(events))
    known = {(e.source, e.command): e.stamp - grid.daq for e in events if e.kind == EventKind.RESUMED}
    known |= {(e.source, e.command): e.applied_at for e in events if e.kind == EventKind.LATE}
    heard = _heard_late(recording)
    latches = list(_latches(events, scenario, grid))
    inputs = [found for event in events if (found := _said(event, event.stamp - grid.daq, linked))]
    reached: dict[int, int] = {}  # source -> instant of its last command: they keep their order
    for command in commands:
        name = command.source, command.sequence
        if name in left_out:
            continue
        instant = max(known.get(name, _in_time(command, latches, grid)), heard.get(command.sample_stamp, 0))
        reached[command.source] = instant = max(instant, reached.get(command.source, 0))
        inputs.append(Input(instant, command))
    return sorted(inputs, key=lambda entry: (entry.instant, entry.command is not None))


def _has_bad_link(events: list[Any], scenario: Scenario) -> bool:
    """Is there a fault of the link at some time of the run?"""
    injections = (json.loads(injected(event)) for event in events if is_injection(event))
    targets = [fault.target for fault in scenario.fault] + [fault["target"] for fault in injections]
    return any(target.startswith(f"{LINKS}.") for target in targets)


def _said(event: Any, instant: int, linked: bool) -> Input | None:
    """What an operator has said by an event, or what the plant has refused, in the order in which it was said."""
    if event.kind == EventKind.REFUSED and not linked:
        return Input(instant, None, refused=event)
    if event.kind == EventKind.RESET:
        return Input(instant, None)
    if is_setting(event):
        return Input(instant, None, setting=setting_of(event.text))
    if is_injection(event):
        return Input(instant, None, fault=injected(event))
    return Input(instant, None, ended=name) if (name := withdrawn(event)) else None


def _heard_late(recording: Recording) -> dict[int, int]:
    """Stamps of measurements that a fault of the link has held back: when the controller had them [ns]."""
    known = ((stamp_in(entry), entry.log_time) for entry in recording.of("measurement"))
    found: dict[int, int] = {}
    for stamp, instant in known:
        if stamp != instant:
            found[stamp] = min(instant, found.get(stamp, instant))
    return found


def _in_time(command: Any, latches: list[Latch], grid: Sampling) -> int:
    """When a command that is not late may be handed in: at its sample, or at the reset that let it in [ns]."""
    resets = [
        latch.until
        for latch in latches
        if command.apply_at > latch.since and latch.sampled <= command.sample_stamp < latch.until
    ]
    return max([-(-command.sample_stamp // grid.daq) * grid.daq, *resets])


def _latches(events: list[Any], scenario: Scenario, grid: Sampling) -> Iterator[Latch]:
    """The times that a reset has ended: of one that a command has ended, its event says which command."""
    left = [event for event in events if event.kind in (EventKind.RESET, EventKind.RESUMED)]
    timeout = to_ns(scenario.loop.command_timeout)
    for safe in (event for event in events if event.kind == EventKind.SAFE):
        end = next((event for event in left if event.stamp >= safe.stamp), None)
        if end is not None and end.kind == EventKind.RESUMED:
            continue
        reset = 1 << 62 if end is None else end.stamp - grid.daq
        if safe.command:  # by an alarm: commands before it were heard, and those of its own time refused
            yield Latch(safe.applied_at, reset, safe.applied_at)
        elif scenario.loop.after_timeout == "latch":
            yield Latch(safe.applied_at - grid.sample - timeout, reset)
