"""Queries that inject a fault into a rig that runs."""

from typing import Any

from bridge.errors import UsageError
from bridge.loop.plant import PlantSide
from bridge.processes.orders import Act, parsed
from bridge.scenario import Scenario, check
from bridge.scenario.faults import PROCESS_OF
from controller.grid import NS


def injected_by(payload: bytes, scenario: Scenario) -> Act:
    """What a table of a fault, such as {"target": "sensor.p2", "kind": "stuck"}, asks for. Raises UsageError."""
    table = parsed(payload)
    if not isinstance(table, dict):
        raise UsageError('send a table, such as {"target": "sensor.p2", "kind": "stuck", "lasts": "2 s"}')
    at_once = not {"at", "when"} & table.keys()
    told = {**table, "at": 0.0} if at_once else table
    fault = check(scenario.model_dump(mode="json") | {"fault": [told]}, "fault").fault[0]
    fault = fault.model_copy(update={"at": None}) if at_once else fault
    if fault.target.startswith(f"{PROCESS_OF}."):
        raise UsageError("a fault of a process stands in the scenario of a `hydrotwin run`, which starts the processes")

    def act(side: PlantSide) -> dict[str, Any]:
        taken = side.inject(fault)
        begins = [begin / NS for begin in taken.begins]
        return {"injected": taken.name, "what": taken.words, "begins": begins}

    return act
