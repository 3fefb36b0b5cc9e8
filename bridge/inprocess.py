"""The loop in one process: no middleware, no clock; the same plant and controller sides, the same bytes."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from bridge.controller_side import ControllerSide
from bridge.host import host, versions
from bridge.identity import derived
from bridge.messages import Outgoing, encode
from bridge.plant_side import PlantSide
from bridge.recording.order import Order, Ordered
from bridge.recording.reader import read
from bridge.recording.writer import RecordingWriter
from bridge.scenario import Scenario
from bridge.summary import summarise


def exchange(plant: PlantSide, controller: ControllerSide, ticks: int, lean: bool = False) -> Iterator[list[Outgoing]]:
    """The messages of each tick, the controller's answers included; `lean`: measurements and answers alone."""
    out = plant.start()
    for _ in range(ticks):
        answers = controller.answer(plant.measurement)
        for answer in answers:
            if answer.topic == "command":
                plant.take(answer.message)
        yield out + answers
        out = plant.tick(lean)
    yield out + controller.answer(plant.measurement)


def record_in_process(scenario: Scenario, path: Path, progress: Callable[[int], None] = lambda tick: None) -> dict[str, Any]:
    """Run a scenario and record it; returns the summary."""
    plant, controller = sides(scenario)
    grid = scenario.loop.grid()
    writer, order = RecordingWriter(path, scenario.rig_name), Order(grid, controlled=True)
    writer.metadata("run", manifest(scenario, plant.run_id))
    for tick, messages in enumerate(exchange(plant, controller, scenario.ticks)):
        for message in messages:
            _write(writer, order.add(message.topic, message.log_time, message.sequence, encode(message.message)))
        progress(tick)
    for message in plant.finish(f"complete after {plant.tick_number} ticks"):
        _write(writer, order.add(message.topic, message.log_time, message.sequence, encode(message.message)))
    _write(writer, order.rest())
    writer.flush()
    summary = summarise(read(path), scenario, {})
    writer.metadata("summary", summary)
    writer.close()
    return summary


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


def _write(writer: RecordingWriter, entries: Iterator[Ordered]) -> None:
    for topic, log_time, sequence, payload in entries:
        writer.write(topic, log_time, sequence, payload)
        writer.flush_by(log_time)
