"""Somebody who wants in: attempts of each kind with real Zenoh sessions, paced, on loopback, so many and no more.

`python -m tests.support.intruders KEYS FOREIGN ENDPOINT SECONDS SPEC...`, with SPEC such as `replay=15` (per second),
prints as JSON what was tried, how often it got in, and the processor time that it took.
"""

import itertools
import json
import re
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import zenoh

from bridge.wire.limits import MESSAGE

KEY = "rig/command"
PATIENCE_MS = 150  # for a connection that will not come
OWN = r'"connect_certificate_base64": ".*",\n +"connect_private_key_base64": ".*"'
BLOCK = zenoh.CongestionControl.BLOCK
Attempt = Callable[[], bool]  # one try; did it get in?


class Intruder:
    """One process of them."""

    def __init__(self, keys: Path, foreign: Path, endpoint: str) -> None:
        self.endpoint = endpoint
        self.texts = {role: (keys / f"{role}.json5").read_text() for role in ("viewer", "controller")}
        self.foreign = (foreign / "controller.json5").read_text()
        self.sessions: list[Any] = []
        self.heard: list[tuple[bytes, bytes]] = []  # commands and their attachments, as a viewer sees them

    def attempt(self, kind: str) -> Attempt:
        """How to try a kind once."""
        ours = self.texts["controller"]
        own = re.search(OWN, self.foreign)
        assert own
        connections = {
            "no certificate": [re.sub(r'"enable_mtls": true,\n|' + OWN + ",", "", ours)],
            "wrong user": [re.sub('"user": ".*"', '"user": "root"', ours)],
            "wrong password": [re.sub('"password": ".*"', '"password": "1234"', ours)],
            "wrong key": [re.sub(OWN, own[0], ours)],
            "flood": ["{}"],
        }
        if kind in connections:
            return lambda: self._connects(connections[kind][0], self.endpoint.replace("tls/", "tcp/", kind == "flood"))
        role = {"viewer replay": "viewer", "replay": "controller", "oversize": "controller"}[kind]
        session = self._joined(role)
        if kind == "oversize":
            return lambda: session.put(KEY, b"\0" * (MESSAGE + 1), congestion_control=BLOCK) is not None
        self._listen()
        turns = itertools.count()
        return lambda: self._replays(session, next(turns))

    def close(self) -> None:
        """Leave."""
        for session in self.sessions:
            session.close()

    def _connects(self, text: str, endpoint: str) -> bool:
        try:
            session = zenoh.open(self._config(text, endpoint))
        except zenoh.ZError:
            return False
        session.close()
        return True

    def _config(self, text: str, endpoint: str, patience: int = PATIENCE_MS) -> Any:
        config = zenoh.Config.from_json5(text)
        config.insert_json5("mode", '"client"')
        config.insert_json5("scouting/multicast/enabled", "false")
        config.insert_json5("connect/endpoints", json.dumps([endpoint]))
        config.insert_json5("connect/timeout_ms", str(patience))
        config.insert_json5("connect/exit_on_failure", "true")
        once = 60_000 if patience == PATIENCE_MS else 100  # one attempt is one connection
        config.insert_json5("connect/retry", f"{{period_init_ms: {once}, period_max_ms: {once}}}")
        return config

    def _joined(self, role: str) -> Any:
        session = zenoh.open(self._config(self.texts[role], self.endpoint, 10_000))
        self.sessions.append(session)
        return session

    def _listen(self) -> None:
        """Keep the commands that the controller sends, as they are."""
        ear = self._joined("viewer")
        self.ear = ear.declare_subscriber(KEY, self._keep)
        deadline = time.monotonic() + 20.0
        while len(self.heard) < 20 and time.monotonic() < deadline:
            time.sleep(0.05)
        self.ear.undeclare()

    def _keep(self, sample: Any) -> None:
        if sample.attachment is not None and len(self.heard) < 20:
            self.heard.append((sample.payload.to_bytes(), sample.attachment.to_bytes()))

    def _replays(self, session: Any, turn: int) -> bool:
        payload, attachment = self.heard[turn % len(self.heard)]
        session.put(KEY, payload, attachment=attachment, congestion_control=BLOCK)
        return False


def paced(rate: float, seconds: float) -> Iterator[int]:
    """So many a second, by the clock."""
    start = time.monotonic()
    for number in range(round(rate * seconds)):
        time.sleep(max(0.0, start + number / rate - time.monotonic()))
        yield number


def main() -> None:
    """Try it all, kinds in turn."""
    keys, foreign, endpoint, seconds, *specs = sys.argv[1:]
    intruder = Intruder(Path(keys), Path(foreign), endpoint)
    rates = {kind: int(rate) for kind, _, rate in (spec.partition("=") for spec in specs)}
    attempts = {kind: intruder.attempt(kind) for kind in rates}
    turns = itertools.cycle(sorted((k / rate, kind) for kind, rate in rates.items() for k in range(rate)))
    print("ready", flush=True)
    sys.stdin.readline()
    began = time.process_time(), time.monotonic()
    tried, entered = dict.fromkeys(rates, 0), 0
    for _ in paced(sum(rates.values()), float(seconds)):
        _, kind = next(turns)
        entered += attempts[kind]()
        tried[kind] += 1
    used, took = time.process_time() - began[0], time.monotonic() - began[1]
    time.sleep(1.0)  # for what is on the wire
    intruder.close()
    print(json.dumps({"tried": tried, "entered": entered, "processor": used, "took": took}), flush=True)


if __name__ == "__main__":
    main()
