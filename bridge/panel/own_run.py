"""The run that a panel starts itself: plant and controller, a recorder and a follower when they are asked for."""

import signal
import time
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import NamedTuple

from bridge.errors import UsageError
from bridge.machine.priority import Priority
from bridge.processes.child import Child
from bridge.recording.names import own_name
from bridge.scenario import Scenario, load
from bridge.scenario.circuit import circuit_of
from bridge.scenario.files import names
from bridge.scenario.loading import refuse_fast_daq
from bridge.wire.link import DEFAULT_ENDPOINT, Link, free_endpoint, is_free

ENDLESS = 3600.0  # [s], of a run that goes on until somebody ends it
STARTING = 300.0  # [s] that plant and controller get: the first start of a drive compiles, on a busy machine for long
FAREWELL = 8.0  # [s] that they get to end in order


class Wish(NamedTuple):
    """What is to be run."""

    scenario: str
    changes: tuple[str, ...] = ()
    endless: bool = True  # past the scenario's duration, until it is stopped
    priority: Priority = Priority.AUTO


class OwnRun:
    """Plant and controller of one run, children of ours."""

    def __init__(self, wish: Wish, folder: Path, environment: Mapping[str, str]) -> None:
        """Raises UsageError for a scenario that cannot be run."""
        self.wish = wish
        self.scenario = load(wish.scenario, list(wish.changes))
        refuse_fast_daq(self.scenario, 1.0)
        circuit_of(self.scenario)
        self.endpoint = DEFAULT_ENDPOINT if is_free(DEFAULT_ENDPOINT) else free_endpoint()
        self.recording: Path | None = None
        self._names = ExitStack()
        self._folder, self._environment = folder, environment
        self._children: dict[str, Child] = {}
        self._file = folder / "scenario.json"
        self._file.write_text(_lasting(self.scenario, wish.endless).model_dump_json(), encoding="utf-8")
        how = ["--quiet", "--priority", wish.priority]
        awaited = ["--await", "controller", "--await", "operator", "--patience", f"{STARTING:g}"]
        self._begin("plant", [str(self._file), "--listen", self.endpoint, *awaited, *how])
        self._begin("controller", [str(self._file), *self._joining, *how])

    @property
    def link(self) -> Link:
        """Where its plant listens."""
        return Link(None, self.endpoint, None, 2.0)

    def failed(self) -> str | None:
        """What one of its processes says of its failure."""
        return next((fault for child in self._children.values() if (fault := child.fault())), None)

    def going(self, role: str) -> bool:
        """Is one of its processes there?"""
        return role in self._children and not self._children[role].ended()

    def record(self) -> Path:
        """Begin a recording; it closes with the run, or by `end`."""
        if self.going("record"):
            raise UsageError(f"{self.recording} is being written already")
        path = Path("runs") / f"{self.scenario.name}-{time.strftime('%Y%m%d-%H%M%S')}.mcap"
        self.recording = self._names.enter_context(own_name(path))
        self._begin("record", ["--output", str(self.recording), "--rig", self.scenario.rig_name, *self._joining])
        return self.recording

    def follow(self) -> None:
        """Start a follower that judges the rig's health, too."""
        if self.going("follow"):
            raise UsageError("a follower is there already")
        self._begin("follow", [self.scenario.rig_name, "--health", "--quiet", *self._joining])

    def end(self, role: str) -> None:
        """End a recorder or a follower in order."""
        if role in self._children:
            self._children[role].ask()

    def stop(self) -> None:
        """End the run in order, recording and all; afterwards nothing of it is left."""
        plant = self._children["plant"]
        with suppress(ProcessLookupError):
            plant.process.send_signal(signal.SIGINT)
        deadline = time.monotonic() + FAREWELL
        while any(not child.ended() for child in self._children.values()) and time.monotonic() < deadline:
            time.sleep(0.02)
        for child in self._children.values():
            child.end()
        self._names.close()

    @property
    def _joining(self) -> list[str]:
        return ["--connect", self.endpoint, "--patience", f"{STARTING:g}"]

    def _begin(self, role: str, arguments: list[str]) -> None:
        self._children[role] = Child(role, arguments, self._folder, self._environment)


def startable(given: str | None) -> list[str]:
    """What a page may start: built-in scenarios and the one that the command line has named; a law is code."""
    return [*([given] if given and given not in names() else []), *names()]


def _lasting(scenario: Scenario, endless: bool) -> Scenario:
    if not endless:
        return scenario
    period = scenario.loop.daq_period
    return scenario.model_copy(update={"duration": round(max(ENDLESS, scenario.duration) / period) * period})
