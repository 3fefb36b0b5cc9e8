"""`hydrotwin run`: start plant, controller and recorder, watch over them, leave nothing running."""

import os
import signal
import tempfile
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from bridge.machine.children import guarded
from bridge.machine.narrator import Narrator
from bridge.machine.process import Stop
from bridge.processes.child import Child
from bridge.processes.failing import Failing, refuse_processes
from bridge.processes.options import SLOW, RunOptions
from bridge.processes.starting import EAR, STARTUP, Starter
from bridge.scenario import Scenario
from bridge.wire.bus import Bus
from bridge.wire.codec import decode
from bridge.wire.events import line_of_law
from bridge.wire.link import Link, LinkError, free_endpoint
from bridge.wire.messages import GOING, Mode
from bridge.wire.status import PlantStatus, plant_status

SILENCE = 5.0  # seconds without a word from the plant after which it counts as gone
STANDSTILL = 5.0  # seconds without a turn that no load explains
FAREWELL = 8.0  # seconds that processes get to finish once they should
READING = 0.1  # seconds per simulated second that the recorder gets on top, to read its file for the summary


class Supervisor:
    """One supervised run."""

    def __init__(
        self, scenario: Scenario, options: RunOptions, show: Callable[[PlantStatus, str], None], stop: Stop
    ) -> None:
        self.scenario = scenario
        self.options = options
        self.show = show
        self.stop = stop
        self.faults: list[str] = []
        self.notes: list[str] = []  # what people should know, without being a failure
        self.children: list[Child] = []
        self.recorded = False  # has the run left a recording?
        self._narrator = Narrator(quiet=False)
        self._heard = time.monotonic()
        self._started = False
        self._noted: list[Child] = []
        self._plant_over: float | None = None
        self._asked_to_stop: float | None = None

    def run(self) -> list[str]:
        """Run to the end, whatever happens; every process of ours is gone afterwards. Returns what went wrong."""
        refuse_processes(self.scenario, self.options.mode)
        before = _state(self.options.recording)
        with (
            tempfile.TemporaryDirectory(prefix="hydrotwin-") as folder,
            guarded(self._patience("record")) as environment,
        ):
            endpoint = self.options.listen or free_endpoint()
            try:
                self._start(Path(folder), endpoint, environment)
                self._watch(endpoint)
            finally:
                self._failing.release()
                for child in self.children:
                    child.ask()
                for child in self.children:
                    child.end()
                    self.notes += child.notes()
                self._note_faults(asked=True)
        self.recorded = _state(self.options.recording) not in (None, before)
        if not self.recorded and not self.faults:
            early = "interrupted before it began" if self.stop() else "its processes ended without a word"
            self.faults.append(f"the run has left no recording: {early}")
        return self.faults

    def _start(self, folder: Path, endpoint: str, environment: Mapping[str, str]) -> None:
        starter = Starter(self.scenario, self.options, folder, endpoint, environment)
        self._failing = Failing(self.scenario, self.options.speed, starter.start)
        self.children += starter.all()
        if self.options.mode == Mode.LOCKSTEP:
            self._share_a_processor()

    def _share_a_processor(self) -> None:
        """Plant and controller take turns: on one processor handing over costs half of waking another one up."""
        mine = sorted(os.sched_getaffinity(0))
        for child in self.children:
            together = child.role in ("plant", "controller")
            with suppress(ProcessLookupError):
                os.sched_setaffinity(child.process.pid, mine[:1] if together else mine[1:] or mine)

    def _watch(self, endpoint: str) -> None:
        bus = self._listen(endpoint)
        try:
            looked = time.clock_gettime(time.CLOCK_BOOTTIME)
            while not self._over():
                time.sleep(0.05)
                looked = self._note_standstill(looked)
        finally:
            if bus is not None:
                bus.close()
            self._narrator.close()

    def _note_standstill(self, looked: float) -> float:
        """Whoever stands still has been suspended, and the run with it; the clock counts a computer's sleep too."""
        now = time.clock_gettime(time.CLOCK_BOOTTIME)
        if now - looked > STANDSTILL:
            self.faults.append(
                f"the run stood still for {now - looked:.0f} s: the computer or the processes were suspended"
            )
        return now

    def _listen(self, endpoint: str) -> Bus | None:
        """Our own ear for what the processes say of themselves; the plant waits for it, so that nothing is missed."""
        deadline = time.monotonic() + STARTUP
        while time.monotonic() < deadline and not self.stop():
            try:
                bus = Bus(Link(None, endpoint, None, 1.0), self.scenario.rig_name, EAR, blocking=False)
            except LinkError:
                if any(child.ended() for child in self.children):
                    return None
                continue
            bus.subscribe("status", self._on_status)
            bus.subscribe("said", self._on_said)
            bus.subscribe("event", self._failing.hear)
            bus.announce()
            self._heard = time.monotonic()
            return bus
        return None

    def _on_status(self, sample: Any) -> None:
        message = decode(sample.payload.to_bytes(), "status")
        status = plant_status(message)
        if status is None:
            return
        self._heard, self._started = time.monotonic(), True
        if message.phase not in GOING:
            self._plant_over = self._plant_over or time.monotonic()
        self.show(status, message.phase)

    def _on_said(self, sample: Any) -> None:
        with suppress(ValueError):
            self._narrator.say(line_of_law(decode(sample.payload.to_bytes(), "said")))

    def _over(self) -> bool:
        now = time.monotonic()
        self._failing.act(self.children)
        ended = all(child.ended() for child in self._who_end())
        self._note_faults()  # of all who have ended by then, too
        if ended:
            return True
        if self._asked_to_stop is not None:
            return self._too_slow(now - self._asked_to_stop)
        if self.stop() or (self.faults and not self._plant_over):
            return self._ask_to_stop(now)
        if self._plant_over is not None:
            return self._too_slow(now - self._plant_over)
        return self._silent(now)

    def _note_faults(self, asked: bool = False) -> None:
        """Take down each failed process once; of those that we have asked to end only who was killed by others."""
        self._noted += [child for child in self._failing.killed if child not in self._noted]
        for child in self.children:
            if child not in self._noted and (child.killed() or not asked) and (fault := child.fault()):
                self._noted.append(child)
                self.faults.append(fault)

    def _who_end(self) -> list[Child]:
        """Those that end with the run by themselves; a router goes on until it is ended."""
        return [child for child in self.children if child.role != "router"]

    def _ask_to_stop(self, now: float) -> bool:
        """Let the plant end the run, so that the recording closes well; True when it has not begun one yet."""
        self._asked_to_stop = now
        plant = self.children[0]
        if not self._started or plant.ended():
            return not self._started
        plant.process.send_signal(signal.SIGINT)
        return False

    def _too_slow(self, waited: float) -> bool:
        """End those that had their time to finish, and name them; True when nobody is left to wait for."""
        for child in self._who_end():
            patience = self._patience(child.role)
            if waited > patience and not child.ended():
                self.faults.append(f"the {child.role} (pid {child.process.pid}) {SLOW} {patience:g} s and was killed")
                self._noted.append(child)
                child.end()
        return False

    def _patience(self, role: str) -> float:
        """Seconds that a process has to finish; the recorder reads its file then."""
        return FAREWELL + (READING * self.scenario.duration if role == "record" else 0.0)

    def _silent(self, now: float) -> bool:
        patience = SILENCE + self.options.patience if self._started else STARTUP
        if now - self._heard < patience:
            return False
        plant = self.children[0]
        what = "has said nothing" if self._started else "has not started"
        self.faults.append(f"the plant (pid {plant.process.pid}) {what} for {patience:g} s")
        return True


def _state(file: Path) -> tuple[int, int, int] | None:
    """What changes when a file is written; None where there is none, or nothing in it."""
    if not file.is_file() or not file.stat().st_size:
        return None
    found = file.stat()
    return found.st_ino, found.st_size, found.st_mtime_ns
