"""Remote control of a replay by queries to RIG/replay/VERB; the value, if there is one, is the query's payload."""

import json
from concurrent.futures import TimeoutError
from typing import Any

import zenoh

from bridge.errors import RunError
from bridge.replay.player import Player
from bridge.wire.bus import Bus

PATIENCE = 5.0  # seconds


def answer_queries(bus: Bus, rig_name: str, player: Player) -> Any:
    """Heed queries for as long as what this returns is kept."""

    def on_query(query: Any) -> None:
        verb = str(query.key_expr).rpartition("/")[2]
        value = query.payload.to_string() if query.payload is not None else str(query.parameters)
        try:
            found = player.ask(verb, value).result(PATIENCE)
        except TimeoutError:
            found = {"error": "the replay does not answer"}
        query.reply(f"{rig_name}/replay/{verb}", json.dumps(found).encode())

    handler = zenoh.handlers.Callback(on_query, indirect=True)
    return bus.session.declare_queryable(f"{rig_name}/replay/*", handler)


def ask(bus: Bus, verb: str, value: str = "") -> dict[str, Any]:
    """Ask a replay on the bus for something; its status. Raises RunError when none answers, or it cannot do that."""
    for reply in bus.session.get(f"{bus.rig_name}/replay/{verb}", payload=value, timeout=PATIENCE):
        if reply.ok is not None:
            found = json.loads(reply.ok.payload.to_bytes())
            if "error" in found:
                raise RunError(found["error"])
            return found
    raise RunError(f"no replay of rig {bus.rig_name!r} answers: start one with `hydrotwin replay FILE`")
