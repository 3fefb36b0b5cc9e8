"""The loop in one process: no middleware, no clock; the same plant and controller sides, the same bytes."""

from collections.abc import Callable
from pathlib import Path

from bridge.errors import RunError
from bridge.loop.exchange import exchange, sides
from bridge.recording.manifest import manifest
from bridge.recording.reader import Entry, Recording, recording
from bridge.recording.summary import summarise
from bridge.recording.writer import new_recording
from bridge.scenario import Scenario


def record_in_process(
    scenario: Scenario,
    path: Path,
    progress: Callable[[int], None] = lambda tick: None,
    stopped: Callable[[], bool] = lambda: False,
) -> Recording:
    """Run a scenario and record it; returns what the file holds."""
    plant, controller = sides(scenario)
    writer = new_recording(path, scenario.rig_name)
    head = manifest(scenario, plant.run_id)
    writer.metadata("run", head)
    entries: list[Entry] = []
    try:
        for tick, messages in enumerate(exchange(plant, controller, scenario.ticks, stopped=stopped)):
            entries += writer.instant(messages)
            progress(tick)
    except RunError:
        writer.close()
        raise
    summary = summarise(recording(path, entries, {}), scenario, {})
    writer.metadata("summary", summary)
    writer.close()
    return recording(path, entries, {"run": head, "summary": summary})
