"""The loop in one process: no middleware, no clock; the same plant and controller sides, the same bytes."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from bridge.loop.controller import ControllerSide
from bridge.loop.identity import derived
from bridge.loop.plant import PlantSide
from bridge.machine.host import host, versions
from bridge.recording.reader import Entry, Recording, recording
from bridge.recording.summary import summarise
from bridge.recording.writer import RecordingWriter
from bridge.scenario import Scenario
from bridge.wire.messages import Outgoing, encode


def exchange(
    plant: PlantSide,
    controller: ControllerSide,
    ticks: int,
    lean: bool = False,
    stopped: Callable[[], bool] = lambda: False,
) -> Iterator[list[Outgoing]]:
    """The messages of each tick, the controller's answers included; `lean`: measurements and answers alone."""
    out = plant.start()
    while plant.tick_number < ticks and not stopped():
        answers = controller.answer(plant.measurement)
        for answer in answers:
            if answer.topic == "command":
                plant.take(answer.message)
        yield out + answers
        out = plant.tick(lean)
    ending = "complete" if plant.tick_number == ticks else "interrupted"
    yield out + controller.answer(plant.measurement) + plant.finish(f"{ending} after {plant.tick_number} ticks")


def record_in_process(
    scenario: Scenario,
    path: Path,
    progress: Callable[[int], None] = lambda tick: None,
    stopped: Callable[[], bool] = lambda: False,
) -> Recording:
    """Run a scenario and record it; returns what the file holds."""
    plant, controller = sides(scenario)
    writer = RecordingWriter(path, scenario.rig_name)
    head = manifest(scenario, plant.run_id)
    writer.metadata("run", head)
    entries: list[Entry] = []
    for tick, messages in enumerate(exchange(plant, controller, scenario.ticks, stopped=stopped)):
        entries += _write(writer, messages)
        progress(tick)
    summary = summarise(recording(path, entries, {}), scenario, {})
    writer.metadata("summary", summary)
    writer.close()
    return recording(path, entries, {"run": head, "summary": summary})


def sides(scenario: Scenario) -> tuple[PlantSide, ControllerSide]:
    """Plant and controller of the run that the scenario's seed names."""
    run_id = derived(scenario.seed, scenario.rig_name)
    return PlantSide(scenario, run_id), ControllerSide(scenario, derived(scenario.seed, "controller"))


def manifest(scenario: Scenario, run_id: int) -> dict[str, Any]:
    """The head of an in-process recording."""
    return {
        "run_id": str(run_id),
        "mode": "inprocess",
        "speed": 0.0,
        "scenario": scenario.model_dump(mode="json"),
        "versions": versions(),
        "host": host(),
        "recorded": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
    }


def _write(writer: RecordingWriter, messages: list[Outgoing]) -> list[Entry]:
    """Write what belongs to one instant, in the order of a lockstep recording."""
    entries = [Entry(m.topic, m.log_time, m.sequence, encode(m.message)) for m in sorted(messages, key=_place)]
    for topic, log_time, sequence, payload in entries:
        writer.write(topic, log_time, sequence, payload)
    writer.flush_by(messages[0].log_time)
    return entries


def _place(message: Outgoing) -> tuple[int, str, int]:
    return message.log_time, message.topic, message.sequence
