"""A recording through the twin or a controller: residuals published, recorded and judged."""

from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

from bridge.errors import RunError, UsageError
from bridge.loop.controller import ControllerSide
from bridge.machine.process import Stop
from bridge.recording.compare import compare
from bridge.recording.entries import Entry
from bridge.recording.imported import is_measured
from bridge.recording.reader import Recording, read
from bridge.recording.reader import recording as in_memory
from bridge.recording.summarise import NEEDED, summarise
from bridge.recording.summary import summary_of
from bridge.recording.writer import RecordingWriter, new_recording
from bridge.replay.into_controller import FedController, heard, only, owner, through_side
from bridge.replay.into_plant import through_plant
from bridge.replay.residual import ReplayResult, Residuals, events_apart
from bridge.scenario import Scenario, changed
from bridge.scenario.channels import layout_of
from bridge.scenario.circuit import circuit_of
from bridge.wire.bus import Bus
from bridge.wire.link import Link, free_endpoint
from bridge.wire.messages import CHANNELS_TOPIC, Outgoing

REPLACING = ("controller.law", "controller.kind")  # changes that put another law in the recorded one's place
COMPARED = {"plant": ("measurement", CHANNELS_TOPIC, "state"), "controller": ("command", "reference", "signals")}


class Through(NamedTuple):
    """How a recording is replayed into something."""

    into: str  # plant, controller
    output: Path
    changes: Sequence[str] = ()
    tolerances: Mapping[str, str] | None = None
    alone: bool = False  # the controller without a process of its own, nothing published
    listen: str | None = None  # where the residual is published; None: a free address on loopback


def replay_through(path: Path, request: Through) -> ReplayResult:
    """Replay and judge. Raises UsageError for a file that cannot be replayed, RunError when a process fails."""
    if request.output.resolve() == path.resolve():
        raise UsageError(f"{path}: would be overwritten; name another file with --output")
    recording = read(path)
    scenario = _scenario(recording, request.changes)
    if request.into == "controller":
        _refuse_law_in_memory(recording, request.changes)
        recording = only(recording, owner(recording))
    else:
        circuit_of(scenario)  # refused before a file is begun
    run = recording.metadata["run"]
    writer = new_recording(request.output, scenario.rig_name, layout_of(scenario))
    replayed = {"file": path.name, "into": request.into, "changes": list(request.changes)}
    head = run | {"scenario": scenario.model_dump(mode="json"), "mode": "replay", "replayed": replayed}
    writer.metadata("run", head)
    residuals = Residuals(recording, int(run["run_id"]))
    entries = _written(writer, _replayed(recording, scenario, request, residuals))
    writer.flush()
    verdict = _judge(recording, in_memory(request.output, entries, {"run": head}), request)
    writer.metadata("summary", summarise(read(request.output, NEEDED, growing=True), scenario, {}).plain())
    writer.metadata("replay", {"passed": verdict.passed, "signals": [d._asdict() for d in verdict.differences]})
    writer.close()
    return verdict


def _refuse_law_in_memory(recording: Recording, changes: Sequence[str]) -> None:
    law = recording.metadata.get("run", {}).get("law", {})
    if law.get("in_memory") and not any(change.partition("=")[0] in REPLACING for change in changes):
        raise UsageError(
            f"{recording.path}: the law of this recording, {law['name']!r}, was a function in the memory of a program, "
            "which is not to be had: put it into a file and name that with --set controller.law=FILE.py:function"
        )


def _written(writer: RecordingWriter, replayed: Generator[list[Outgoing], None, None]) -> list[Entry]:
    """All that comes, also in the file. Raises RunError when it fails or is interrupted; the file is whole then too."""
    entries: list[Entry] = []
    stop = Stop()
    try:
        with closing(replayed):
            for messages in replayed:
                entries += writer.instant(messages)
                if stop.listen()():
                    raise RunError(f"interrupted: {writer.path} holds what was replayed so far")
    except RunError:
        writer.close()
        raise
    finally:
        stop.leave()
    return entries


def _scenario(recording: Recording, changes: Sequence[str]) -> Scenario:
    if "run" not in recording.metadata:
        raise UsageError(f"{recording.path}: the recording carries no scenario to replay it with")
    return changed(recording.metadata["run"]["scenario"], changes, str(recording.path))


def _replayed(
    recording: Recording, scenario: Scenario, request: Through, residuals: Residuals
) -> Generator[list[Outgoing], None, None]:
    """The messages of each instant, with their residuals."""
    if request.alone:
        yield from (_with_residuals(out, residuals) for out in _alone(recording, scenario, request.into))
        return
    endpoint = request.listen or free_endpoint()
    role = "replay" if request.into == "plant" else "plant"
    with Bus(Link(endpoint, None, None, 5.0), scenario.rig_name, role, blocking=True) as bus:
        bus.speak_as("replay")
        for out in _through(recording, scenario, request.into, bus, endpoint):
            both = _with_residuals(out, residuals)
            for message in both:
                if message.topic == "residual":
                    bus.publish(message)
            yield both


def _alone(recording: Recording, scenario: Scenario, into: str) -> Iterator[list[Outgoing]]:
    if into == "plant":
        return through_plant(recording, scenario)
    return through_side(heard(recording, scenario), ControllerSide(scenario, owner(recording)))


def _through(recording: Recording, scenario: Scenario, into: str, bus: Bus, endpoint: str) -> Iterator[list[Outgoing]]:
    if into == "plant":
        yield from through_plant(recording, scenario)
        return
    with FedController(bus, endpoint, scenario, owner(recording)) as controller:
        yield from controller.answers(heard(recording, scenario))


def _with_residuals(messages: list[Outgoing], residuals: Residuals) -> list[Outgoing]:
    found = (residuals.of(message) for message in messages)
    return [*messages, *(residual for residual in found if residual is not None)]


def _judge(recorded: Recording, replayed: Recording, request: Through) -> ReplayResult:
    topics = COMPARED[request.into]
    wanted = tuple(topic for topic in topics if recorded.counts.get(topic))
    differences = compare(replayed, recorded, request.tolerances, wanted, partly=_may_lack(recorded, request.into))
    if is_measured(recorded):
        differences = [difference for difference in differences if difference.instants]
    judged = request.into == "plant" and "event" in recorded.counts and not is_measured(recorded)
    events = events_apart(replayed, recorded) if judged else None
    missing = _lost(recorded).get("command" if request.into == "plant" else "measurement", 0)
    return ReplayResult(request.into, differences, events, request.output, missing)


def _may_lack(recorded: Recording, into: str) -> bool:
    """Instants may be missing where messages were lost on the way to the file, it was cut off, or a log has holes."""
    return not recorded.complete or bool(_lost(recorded)) or is_measured(recorded)


def _lost(recorded: Recording) -> Mapping[str, int]:
    summary = summary_of(recorded)
    return summary.lost if summary else {}
