"""What a recording says of its run at its head."""

import time
from typing import Any

from bridge.machine.host import host, versions
from bridge.scenario import Scenario
from bridge.scenario.law_file import law_facts
from bridge.wire.messages import Mode


def manifest(scenario: Scenario, run_id: int) -> dict[str, Any]:
    """The head of an in-process recording."""
    return {
        "run_id": str(run_id),
        "mode": Mode.INPROCESS,
        "speed": 0.0,
        "scenario": scenario.model_dump(mode="json"),
        "versions": versions(),
        "host": host(),
        "recorded": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
        **law_facts(scenario.controller),
    }
