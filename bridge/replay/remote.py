"""Remote control of a replay by queries to RIG/replay/VERB; the value, if there is one, is the query's payload."""

import json
import threading
from collections.abc import Iterator
from concurrent.futures import TimeoutError
from contextlib import contextmanager
from typing import Any

import zenoh

from bridge.errors import RunError
from bridge.replay.player import Player
from bridge.wire.bus import Bus
from bridge.wire.limits import QUERY

PATIENCE = 5.0  # seconds


@contextmanager
def heeding(bus: Bus, rig_name: str, player: Player) -> Iterator[None]:
    """Heed queries; whoever has asked has an answer when this ends, also where what was asked for ended the replay."""
    answering = threading.Lock()

    def on_query(query: Any) -> None:
        if query.payload is not None and len(query.payload) > QUERY:
            query.reply_err(b"refused: too long")
            return
        with answering:
            answer(query)

    def answer(query: Any) -> None:
        verb = str(query.key_expr).rpartition("/")[2]
        payload = query.payload
        value = str(query.parameters) if payload is None else payload.to_bytes().decode(errors="replace")
        try:
            found = player.ask(verb, value).result(PATIENCE)
        except TimeoutError:
            found = {"error": "the replay does not answer"}
        query.reply(f"{rig_name}/replay/{verb}", json.dumps(found).encode())

    handler = zenoh.handlers.Callback(on_query, indirect=True)
    queryable = bus.session.declare_queryable(f"{rig_name}/replay/*", handler)
    try:
        yield
    finally:
        player.close()
        if answering.acquire(timeout=PATIENCE):
            answering.release()
        queryable.undeclare()


def ask(bus: Bus, verb: str, value: str = "") -> dict[str, Any]:
    """Ask a replay on the bus for something; its status. Raises RunError when none answers, or it cannot do that."""
    for reply in bus.session.get(f"{bus.rig_name}/replay/{verb}", payload=value, timeout=PATIENCE):
        if reply.ok is not None:
            found = json.loads(reply.ok.payload.to_bytes())
            if "error" in found:
                raise RunError(found["error"])
            return found
    raise RunError(f"no replay of rig {bus.rig_name!r} answers: start one with `hydrotwin replay FILE`")
