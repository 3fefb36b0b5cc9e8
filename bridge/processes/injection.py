"""Queries that inject a fault into a rig that runs, or end one."""

from typing import Any

from bridge.errors import UsageError
from bridge.loop.plant import PlantSide
from bridge.processes.orders import Act, parsed
from bridge.scenario import Scenario, check
from bridge.scenario.faults import PROCESS_OF
from controller.grid import NS


def injected_by(payload: bytes, scenario: Scenario) -> Act:
    """What a table of a fault, such as {"target": "sensor.p2", "kind": "stuck"}, asks for, or {"end": "its name"}.

    Raises UsageError.
    """
    table = parsed(payload)
    if not isinstance(table, dict):
        raise UsageError('send a table, such as {"target": "sensor.p2", "kind": "stuck", "lasts": "2 s"}')
    if "end" in table:
        return _ended_by(table)
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


def _ended_by(table: dict[str, Any]) -> Act:
    name = table["end"]
    if table.keys() != {"end"} or not isinstance(name, str):
        raise UsageError('to end a fault send its name alone: {"end": "sensor.p2 stuck"}')

    def act(side: PlantSide) -> dict[str, Any]:
        ended = side.end_fault(name)
        return {"ended": ended.name, "what": ended.words, "at": side.now / NS}

    return act
