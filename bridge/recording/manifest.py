"""What a recording says of its run at its head."""

import time
from typing import Any

from bridge.errors import RunError
from bridge.machine.host import host, versions
from bridge.scenario import Scenario
from bridge.scenario.law_file import law_facts
from bridge.scenario.untrusted import parsed_json
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


def told_by(answer: bytes, rig_name: str) -> dict[str, Any]:
    """What a plant says of its run when asked. Raises RunError for an answer that is not of a plant."""
    try:
        told = parsed_json(answer)
        known = told | {"run_id": int(told["run_id"])}
        if isinstance(told["scenario"], dict) and isinstance(told["tick"], int) and isinstance(told["mode"], str):
            return known
    except (ValueError, KeyError, TypeError, OverflowError):
        pass
    raise RunError(f"who answers as the plant of rig {rig_name!r} does not say what it runs: it is not a plant of ours")
