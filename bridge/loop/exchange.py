"""Plant and controller of a scenario in one process, without clock and network: the reference for all other modes."""

from collections.abc import Callable, Iterator

from bridge.errors import ScenarioError
from bridge.loop.controller import ControllerSide
from bridge.loop.identity import derived
from bridge.loop.plant import Heard, PlantSide
from bridge.scenario import Scenario
from bridge.scenario.faults import PROCESS_OF
from bridge.wire.events import last_words
from bridge.wire.messages import Ending, Outgoing
from controller.laws import ControlLaw


def exchange(
    plant: PlantSide,
    controller: ControllerSide,
    ticks: int,
    lean: bool = False,
    stopped: Callable[[], bool] = lambda: False,
) -> Iterator[list[Outgoing]]:
    """The messages of each tick, the controller's answers included; `lean`: measurements, events and answers alone."""
    out = plant.start()
    while plant.tick_number < ticks and not stopped():
        yield out + answered(plant, controller, out)
        out = plant.tick(lean)
    ticks_run = plant.tick_number
    ending = Ending.COMPLETE if ticks_run == ticks else Ending.INTERRUPTED
    yield out + answered(plant, controller, out) + plant.finish(last_words(ending, ticks_run))


def answered(plant: PlantSide, controller: ControllerSide, out: list[Outgoing]) -> list[Outgoing]:
    """What the controller says to the newest measurement; its command is with the plant then.

    out: the plant's messages of this tick, whose events the controller heeds for its next answer.
    """
    answers = [answer for heard in plant.heard for answer in _answer(plant, controller, heard)]
    for answer in answers:
        if answer.topic == "command":
            plant.take(answer.message)
    for event in out:
        if event.topic == "event":
            answers += controller.heed(event.message)
    return answers


def _answer(plant: PlantSide, controller: ControllerSide, heard: Heard) -> list[Outgoing]:
    """What the controller says to one scan."""
    if controller.waits(heard.measurement.stamp):
        if controller.sees_truth:
            controller.see(plant.true_state())
        if controller.reads_channels:
            controller.hear(heard.channels)
    return controller.answer(heard.measurement)


def sides(scenario: Scenario, law: ControlLaw | None = None) -> tuple[PlantSide, ControllerSide]:
    """Plant and controller of the run that the scenario's seed names; with another law, if there is one.

    Raises ScenarioError for a fault of a process: here is none.
    """
    for fault in scenario.fault:
        if fault.target.startswith(f"{PROCESS_OF}."):
            raise ScenarioError(f"fault {fault.target} {fault.kind}: in one process there is none; use --mode realtime")
    run_id = derived(scenario.seed, scenario.rig_name)
    return PlantSide(scenario, run_id), ControllerSide(scenario, derived(scenario.seed, "controller"), law)
