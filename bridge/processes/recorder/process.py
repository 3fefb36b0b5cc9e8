"""The recorder as a process: everything on a rig's keys into MCAP files, losses counted."""

import queue
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from bridge.errors import RunError
from bridge.machine.priority import Priority, ease, take_behind
from bridge.machine.process import NOTE, Stop
from bridge.processes.contact import Contact, is_farewell
from bridge.processes.recorder.run_file import Arrival, Request, RunFile
from bridge.recording.manifest import told_by
from bridge.wire.access import SAVING
from bridge.wire.bus import Bus, stamp_of
from bridge.wire.codec import decode
from bridge.wire.guide import TOKEN
from bridge.wire.limits import WAITING_BYTES, WAITING_RECORDS
from bridge.wire.link import Link
from bridge.wire.messages import TOPICS, Phase
from controller.grid import NS

DRAIN_PERIOD = 0.02  # seconds; waking for every message would take the loop's processors
FOLLOWING = 60.0  # seconds for a follower, which in lockstep may be behind
PATIENCE = 3.0  # seconds for what was announced to arrive, after the plant's end


class RecorderProcess:
    """Records one run after the other; a new run id starts a new file."""

    def __init__(
        self,
        bus: Bus,
        path: Path,
        patience: float,
        stop: Callable[[], bool],
        request: Request | None = None,
        begun: Callable[[], object] = lambda: None,
    ) -> None:
        self.bus = bus
        self.patience = patience
        self.path = path
        self.stop = stop
        self.begun = begun  # called before there is a file: from then on it must be closed in order
        self.request = request or Request()
        self.overflow: Counter[str] = Counter()  # messages per topic that there was no room for
        self._most = 0  # messages that have waited at a time
        self._began = 0.0, 0.0  # seconds of this process's processor time, and of the wall clock
        self._saves = 0  # triggers from outside that are not heeded yet
        self._came, self._went = 0, 0  # bytes: Zenoh's threads count what comes, ours what is taken
        self._lock = threading.Lock()
        self._inbox: queue.SimpleQueue[tuple[str, Any]] = queue.SimpleQueue()
        for topic in TOPICS:
            if self.request.follows(topic):
                bus.subscribe(topic, lambda sample, topic=topic: self._keep(topic, sample))
        bus.answer(SAVING, self._save)
        bus.watch()
        self._contact = Contact(bus, is_expected=True)

    def run(self) -> list[Path]:
        """Record until the plant has ended or is gone. Raises RunError when no plant answers or the disk refuses."""
        manifest = self._manifest()
        self.begun()
        file = self._opened(self.path, manifest, 0)
        self.bus.announce()
        self._began = time.process_time(), time.monotonic()
        while not self.stop() and not self._over(file):
            time.sleep(DRAIN_PERIOD)
            file = self._drain(file)
        ease()
        written = self._close(file)
        if (
            file.ended_at is None
            and self._contact.lost()
            and (words := self._contact.words(f"t = {file.stamp / NS:g} s"))
        ):
            raise RunError(f"{words}; what was recorded is in {', '.join(map(str, written)) or 'no file'}")
        return written

    def _drain(self, file: RunFile) -> RunFile:
        """Write what has come; gives the file that is then open."""
        well = file.refusal is None
        while self._saves:
            self._saves -= 1
            file.trigger(file.stamp)
        for arrival in self._arrived():
            if TOPICS[arrival.topic].publisher == "plant":
                self._contact.hear()
            if self._is_farewell(arrival):
                continue
            if self._may_begin_another(file) and file.is_of_another_run(arrival):
                file = self._next_file(file)
            file.take(arrival)
            file.flush_by_time()
        file.flush_by_time()
        while file.mixed:
            print(f"{NOTE}{file.mixed.pop(0)}", file=sys.stderr, flush=True)
        if well and file.refusal is not None:
            print(f"{NOTE}{file.refusal}", file=sys.stderr, flush=True)
            self.bus.publish_status(file.run_id, file.stamp, Phase.FAILED, {}, file.refusal)
        return file

    def _close(self, file: RunFile) -> list[Path]:
        file.close(self._facts() | {"lacks": self._lacking(file)})
        unwritten = float(sum(file.unwritten.values()))
        lost = {"lost": float(sum(file.losses().values())), "unwritten": unwritten}
        phase = Phase.FAILED if file.refusal else Phase.ENDED
        self.bus.publish_status(file.run_id, file.stamp, phase, lost, file.refusal or "", final=True)
        if file.refusal:
            raise RunError(f"{file.refusal} ({unwritten:.0f} messages are not in it)")
        return file.paths

    def _facts(self) -> dict[str, Any]:
        """What the recorder says of itself."""
        worked, took = time.process_time() - self._began[0], time.monotonic() - self._began[1]
        share = worked / took if took > 0.0 else 0.0
        turned = {"turned_away": self.bus.turned.counts()} if self.bus.turned.counts() else {}
        own = {"overflow": dict(self.overflow), "most_waiting": self._most, "processor_share": round(share, 4)}
        return own | turned

    def _lacking(self, file: RunFile) -> list[str]:
        """What a controller that spoke does not do, by name; ours does it all."""
        if "command" not in file.spoken:
            return []
        rig = self.bus.rig_name
        found = {
            f"declares no liveliness token {rig}/{TOKEN}/NUMBER": "controller" not in self.bus.present,
            "attaches no stamp to its messages (16 bytes, struct <qQ)": file.unstamped > 0,
            f"publishes no {rig}/reference, so the run is judged against the scenario's": "reference" not in file.spoken
            and self.request.wants("reference"),
        }
        return [f"the controller {what}: see `hydrotwin messages`" for what, lacks in found.items() if lacks]

    def _keep(self, topic: str, sample: Any) -> None:
        """In Zenoh's own thread, which must not wait for a disk."""
        waiting = self._inbox.qsize()
        self._most = max(self._most, waiting)
        if waiting < WAITING_RECORDS and self._came - self._went < WAITING_BYTES:
            with self._lock:
                self._came += len(sample.payload)
            self._inbox.put((topic, sample))
        else:
            self.overflow[topic] += 1

    def _save(self) -> bytes:
        self._saves += 1
        return b"saved" if self.request.window else b"all is recorded anyway"

    def _manifest(self) -> dict[str, Any]:
        answer = self.bus.ask("scenario", self.patience, self.stop)
        if answer is None:
            raise RunError(
                f"no plant of rig {self.bus.rig_name!r} answers: start one first, or name the rig with --rig"
            )
        return told_by(answer, self.bus.rig_name)

    def _opened(self, path: Path, manifest: dict[str, Any], number: int) -> RunFile:
        try:
            return RunFile(path, manifest, self.request, number)
        except OSError as error:
            raise RunError(f"{path}: {error.strerror}: record elsewhere with --output") from None

    def _next_file(self, file: RunFile) -> RunFile:
        """A new file if the plant says that it has begun a new run; else it was somebody's noise."""
        manifest = self._manifest()
        if int(manifest["run_id"]) == file.run_id:
            return file
        self._close(file)
        path = self.path.with_stem(f"{self.path.stem}-{file.number + 1}")
        return self._opened(path, manifest, file.number + 1)

    def _arrived(self) -> Iterator[Arrival]:
        while not self._inbox.empty():
            topic, sample = self._inbox.get()
            payload = sample.payload.to_bytes()
            self._went += len(payload)
            yield Arrival(topic, payload, stamp_of(sample))

    def _is_farewell(self, arrival: Arrival) -> bool:
        """Is it the last word of a replay? That is not of the run that it repeats."""
        if arrival.topic != "status":
            return False
        with suppress(ValueError):
            status = decode(arrival.payload, "status")
            self._contact.heed(status)
            return is_farewell(status)
        return False

    def _may_begin_another(self, file: RunFile) -> bool:
        """A run is kept to as long as its plant may still be among several."""
        return file.ended_at is not None or len(self.bus.present.get("plant", ())) < 2

    def _over(self, file: RunFile) -> bool:
        if file.ended_at is None:
            return self._contact.lost() and self._inbox.empty()
        expected = {"plant"} | ({"controller", "follower"} & set(self.bus.present))
        settled = expected <= file.announced and not file.tally.losses()
        behind = self.bus.present.get("follower") and "follower" not in file.announced
        return settled or time.monotonic() - file.ended_at > (FOLLOWING if behind else PATIENCE)


def run_recorder(
    path: Path,
    rig_name: str,
    link: Link,
    blocking: bool,
    request: Request | None = None,
    priority: Priority = Priority.ORDINARY,
) -> list[Path]:
    """Record a rig until its plant ends; returns the last run's files. Raises RunError or LinkError with one line."""
    stop = Stop()
    with Bus(link, rig_name, "recorder", blocking=blocking) as bus:
        process = RecorderProcess(bus, path, link.patience, stop, request, stop.listen)
        take_behind(priority, is_paced=not blocking)
        return process.run()
