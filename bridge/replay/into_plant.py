"""Recorded commands into the twin: the same plant side as in a run, fed with what the recorded plant was fed with."""

from collections.abc import Iterator

from bridge.errors import UsageError
from bridge.loop.plant import PlantSide
from bridge.recording.reader import Recording
from bridge.replay.schedule import Input, schedule
from bridge.scenario import Scenario
from bridge.scenario.faults import Fault
from bridge.wire.messages import EventKind, Outgoing


def through_plant(recording: Recording, scenario: Scenario) -> Iterator[list[Outgoing]]:
    """The messages of each tick, the recorded commands in between. Raises UsageError when no tick is recorded."""
    ticks = _ticks(recording, scenario)
    side = PlantSide(scenario, int(recording.metadata["run"]["run_id"]))
    inputs = iter(schedule(recording, scenario))
    following = next(inputs, None)
    out = side.start()
    while side.tick_number < ticks:
        yield out
        while following is not None and following.instant <= side.now:
            _hand_in(following, side)
            following = next(inputs, None)
        out = side.tick()
    ended = [event.text for event in recording.messages("event") if event.kind == EventKind.ENDED]
    yield out + (side.finish(ended[0]) if ended else [])


def _hand_in(given: Input, side: PlantSide) -> None:
    if given.setting is not None:
        name, value, over = given.setting
        side.set({name: value}, over)
    elif given.fault:
        side.inject(Fault.model_validate_json(given.fault))
    elif given.refused is not None:
        side.retell(given.refused)
    elif given.ended:
        side.end_fault(given.ended)
    elif given.command is None:
        side.reset()
    else:
        side.take(given.command)


def _ticks(recording: Recording, scenario: Scenario) -> int:
    """How far the recorded run goes."""
    instants = [entry.log_time for topic in ("measurement", "state") for entry in recording.of(topic)]
    if not instants:
        raise UsageError(f"{recording.path}: no measurement in it to compare with")
    return max(instants) // scenario.loop.grid().daq
