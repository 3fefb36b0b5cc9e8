"""The loop in one process: no middleware, no clock; the same plant and controller sides, the same bytes."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bridge.errors import RunError, reason
from bridge.loop.exchange import exchange, sides
from bridge.loop.plant import PlantSide
from bridge.recording.entries import Entry
from bridge.recording.manifest import manifest
from bridge.recording.reader import Recording, recording
from bridge.recording.summarise import summarise
from bridge.recording.summary import Summary
from bridge.recording.writer import RecordingWriter, entries_of
from bridge.scenario import Scenario
from bridge.scenario.channels import layout_of
from bridge.wire.events import last_words
from bridge.wire.messages import CHANNELS_TOPIC, Ending, Outgoing
from bridge.wire.status import PlantStatus
from controller.grid import NS
from controller.laws import ControlLaw

MEMORY = Path("a run in memory")  # in place of a file's name
JUDGED = ("state", "event", "reference", CHANNELS_TOPIC)  # topics that metrics and bands are made of


class RecordingError(RunError):
    """The disk refuses the recording."""


def record_in_process(
    scenario: Scenario,
    path: Path,
    progress: Callable[[int], None] = lambda tick: None,
    stopped: Callable[[], bool] = lambda: False,
    tell: Callable[[Any], None] = lambda event: None,
) -> Recording:
    """Run a scenario and record it; returns what the file holds.

    tell: of each line that the law prints, a `said` event.
    Raises RunError when the disk refuses, or with the recording whole as far as it goes when the law fails.
    """
    plant, controller = sides(scenario)
    head = manifest(scenario, plant.run_id)
    entries: list[Entry] = []
    with _recording(scenario, path, entries) as writer:
        writer.metadata("run", head)
        failure: RunError | None = None
        try:
            for tick, messages in enumerate(exchange(plant, controller, scenario.ticks, stopped=stopped)):
                entries += writer.instant(_told(messages, tell))
                progress(tick)
        except RunError as error:
            failure = error
            said = _told(controller.own.take(), tell)
            entries += writer.instant(said + _failed(plant, str(error)))
        summary = summarise(recording(path, entries, {}), scenario, {}, plant.status()).plain()
        writer.metadata("summary", summary)
    if failure is not None:
        raise failure
    return recording(path, entries, {"run": head, "summary": summary})


def run_in_memory(
    scenario: Scenario, law: ControlLaw | None = None, facts: Mapping[str, Any] = {}, aloud: bool = False
) -> Recording:
    """Run a scenario without a file, with a law in place of its own if there is one. Raises RunError.

    facts: of that law, for the head of the recording. aloud: what the law prints goes where it would go anywhere else.
    """
    plant, controller = sides(scenario, law)
    if aloud:
        controller.own.speak_aloud()
    head = {**manifest(scenario, plant.run_id), **facts}
    entries = [e for messages in exchange(plant, controller, scenario.ticks) for e in entries_of(messages)]
    return _in_memory(scenario, entries, head, plant.status())


def in_memory_recording(scenario: Scenario, entries: list[Entry], run_id: int, status: PlantStatus) -> Recording:
    """What has been kept of a run that somebody else drove."""
    return _in_memory(scenario, entries, manifest(scenario, run_id), status)


def _in_memory(scenario: Scenario, entries: list[Entry], head: dict[str, Any], status: PlantStatus) -> Recording:
    summary = summarise(recording(MEMORY, entries, {}), scenario, {}, status).plain()
    return recording(MEMORY, entries, {"run": head, "summary": summary})


def run_unrecorded(scenario: Scenario) -> tuple[Recording, Summary]:
    """Run a scenario and keep only what metrics and bands are made of. Raises RunError."""
    plant, controller = sides(scenario)
    kept = ([m for m in messages if m.topic in JUDGED] for messages in exchange(plant, controller, scenario.ticks))
    head = {"run": {"scenario": scenario.model_dump(mode="json")}} if scenario.daq.channels else {}
    found = recording(MEMORY, [entry for messages in kept for entry in entries_of(messages)], head)
    return found, summarise(found, scenario, {}, plant.status())


def _told(messages: list[Outgoing], tell: Callable[[Any], None]) -> list[Outgoing]:
    """The messages, the lines of the law among them told."""
    for message in messages:
        if message.topic == "said":
            tell(message.message)
    return messages


def _failed(plant: PlantSide, reason: str) -> list[Outgoing]:
    """The plant's last words on somebody else's failure."""
    return plant.finish(last_words(Ending.FAILED, plant.tick_number, reason))


@contextmanager
def _recording(scenario: Scenario, path: Path, entries: list[Entry]) -> Iterator[RecordingWriter]:
    """A recording that says why it ends where the disk has refused."""
    try:
        writer = RecordingWriter(path, scenario.rig_name, channels=layout_of(scenario))
    except OSError as error:
        raise RecordingError(reason(error)) from None
    try:
        yield writer
        writer.close()
    except RunError:
        writer.close()
        raise
    except OSError as error:
        time = f"{entries[-1].log_time / NS if entries else 0.0:g} s"
        writer.give_up("refused", {"reason": str(error.strerror), "time": time})
        raise RecordingError(
            f"{path}: {error.strerror}: nothing from about t = {time} on is recorded; what was written before stays "
            "readable: free some room, or record elsewhere"
        ) from None
