"""Faults of processes: the supervisor of a run suspends, kills, restarts and slows what it has started.

The plant says when one begins, by its events, so a fault may wait for a time, a signal or an event of the run. When it
ends our clock says: a network that stands lets no word through.
"""

import queue
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from bridge.errors import ScenarioError
from bridge.processes.child import Child
from bridge.scenario import Scenario
from bridge.scenario.faults import PROCESS_OF, PlannedFault, planned
from bridge.wire.codec import decode
from bridge.wire.events import turn_of
from bridge.wire.messages import Mode
from controller.grid import NS

ROLES = {"controller": "controller", "recorder": "record", "network": "router"}  # of what is started
TURN = 20e-3  # [s] in which a slowed process stands once


def faults_of_processes(scenario: Scenario) -> dict[str, PlannedFault]:
    """By their names."""
    return {fault.name: fault for fault in planned(scenario) if fault.group == PROCESS_OF}


def refuse_processes(scenario: Scenario, mode: Mode) -> None:
    """Raises ScenarioError for a fault of a process where there is none to fail, or where nobody may be late."""
    for name, fault in faults_of_processes(scenario).items():
        if mode != Mode.REALTIME:
            raise ScenarioError(
                f"fault {name!r}: {fault.target} fails in real time only, {mode} waits for everybody or has no "
                "processes; run it with --mode realtime"
            )


class Failing:
    """Makes the processes of a run fail."""

    def __init__(self, scenario: Scenario, speed: float, start: Callable[[str, int], Child]) -> None:
        """speed: simulated over wall time; start: starts the process of a role once more, the nth time."""
        self._speed = speed
        self._faults = faults_of_processes(scenario)
        self._start = start
        self._begun: queue.SimpleQueue[PlannedFault] = queue.SimpleQueue()
        self._ends: list[tuple[float, PlannedFault]] = []  # [s, monotonic]
        self._slowed: dict[str, threading.Event] = {}
        self._due: list[tuple[float, str]] = []  # restarts: when [s, monotonic], and whose
        self._started: dict[str, int] = {}
        self.killed: list[Child] = []  # on purpose

    def hear(self, sample: Any) -> None:
        """Take an event of the plant, in Zenoh's thread."""
        with suppress(ValueError):
            turn = turn_of(decode(sample.payload.to_bytes(), "event"))
            if turn is not None and turn.begins and turn.name in self._faults:
                self._begun.put(self._faults[turn.name])

    def act(self, children: list[Child]) -> None:
        """Do what is due to those of the children that are there."""
        now = time.monotonic()
        while not self._begun.empty():
            fault = self._begun.get()
            self._ends.append((now + fault.lasts / NS / self._speed, fault))
            self._turn(children, fault, True)
        for due, fault in [end for end in self._ends if end[0] <= now]:
            self._ends.remove((due, fault))
            self._turn(children, fault, False)
        for due, role in [restart for restart in self._due if restart[0] <= now]:
            self._due.remove((due, role))
            self._started[role] = self._started.get(role, 0) + 1
            children.append(self._start(role, self._started[role]))

    def release(self) -> None:
        """Let all that stand go on: the run ends."""
        for event in self._slowed.values():
            event.set()

    def _turn(self, children: list[Child], fault: PlannedFault, begins: bool) -> None:
        for child in children:
            if child.role == ROLES[fault.part] and not child.ended():
                self._fail(child, fault, begins)

    def _fail(self, child: Child, fault: PlannedFault, begins: bool) -> None:
        if fault.kind == "freeze":
            child.process.send_signal(signal.SIGSTOP if begins else signal.SIGCONT)
        elif fault.kind == "slow":
            self._slow(child, fault, begins)
        elif begins:
            self.killed.append(child)
            child.process.kill()
            if fault.kind == "restart":
                self._due.append((time.monotonic() + fault.sizes["time"], child.role))

    def _slow(self, child: Child, fault: PlannedFault, begins: bool) -> None:
        if not begins:
            if event := self._slowed.pop(fault.name, None):
                event.set()
            return
        over = self._slowed[fault.name] = threading.Event()
        share = fault.sizes["share"]
        threading.Thread(target=_stand, args=(child, share, over), daemon=True).start()


def _stand(child: Child, share: float, over: threading.Event) -> None:
    """Suspend a process for a share of the time until it is over."""
    while not over.is_set() and not child.ended():
        with suppress(ProcessLookupError):
            child.process.send_signal(signal.SIGSTOP)
            over.wait(share * TURN)
            child.process.send_signal(signal.SIGCONT)
        over.wait((1.0 - share) * TURN)
