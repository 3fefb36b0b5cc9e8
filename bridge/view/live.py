"""A running plant in Rerun: a process of its own between Zenoh and the viewer, which the loop cannot notice."""

import os
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import RunError, UsageError
from bridge.machine.children import guarded
from bridge.machine.memory import give_back
from bridge.machine.process import Stop
from bridge.recording.entries import Entry
from bridge.recording.inbox import WATCHED, inbox, run_of
from bridge.recording.manifest import told_by
from bridge.view.content import APPLICATION
from bridge.view.live_drawing import Drawing
from bridge.view.rerun_program import (
    Program,
    connected,
    require_rerun,
    server,
    window,
)
from bridge.view.screenshot import check_target, screenshot
from bridge.wire.bus import Bus
from bridge.wire.link import Link

PERIOD = 0.1  # [s] from look to look at what has come, and from batch to batch of a viewer
FILED = 1.0  # [s] from batch to batch of a file: twenty small ones take ten times the processor time and twice the disk
LEASE = 2.0  # [s] of our silence after which the plant gives us up: until then it cannot leave, nor in lockstep go on
PART = 3000  # messages drawn at once, a second's at 1 kHz: memory for more of them would never be given back
FLUSH = 2.0  # [s] that Rerun has to take a batch; then what comes waits, and in the end is left out
UNINDEXED = "warn,re_log_encoding::rrd::file_sink=error"  # Rerun's log, without its warning that there is no index
PICTURE_AFTER = 4.0  # [s] of simulated time, unless somebody says when


class LiveOptions(NamedTuple):
    """Where to show it."""

    web: bool
    save: Path | None
    picture: Path | None
    at: float | None  # [s], of the picture


def watch(link: Link, rig: str, options: LiveOptions) -> None:
    """Show a running plant until the viewer is closed or Ctrl-C. Raises RunError, LinkError or UsageError."""
    if options.web + (options.save is not None) + (options.picture is not None) > 1:
        raise UsageError("--web serves the view, --save and --screenshot write a file: choose one")
    require_rerun()
    if options.picture:
        check_target(options.picture)
    with guarded(), Bus(link, rig, "viewer", blocking=False, lease=LEASE) as bus:
        live = Live(bus, link.patience, Stop())
        _yield_to_all()
        if options.picture:
            at = PICTURE_AFTER if options.at is None else options.at
            screenshot(options.picture, lambda program: live.follow(program, until=at, bare=True))
        elif options.save:
            live.write(options.save)
        else:
            _show(live, options.web)
        if live.inbox.left_out:
            print(f"{live.inbox.left_out} messages were not drawn: the view was too slow for them, or they too long")


def _show(live: "Live", web: bool) -> None:
    with ExitStack() as stack:
        program = stack.enter_context(server() if web else window())
        if web:
            live.stop.listen()
            print(f"{program.address}\nCtrl-C ends it", flush=True)
        live.follow(program)


class Live:
    """What comes from a rig, drawn batch by batch.

    It takes no status: its last word blocks until all have it, and a stalled viewer would hold the plant.
    """

    def __init__(self, bus: Bus, patience: float, stop: Stop) -> None:
        self.bus = bus
        self.stop = stop
        self.inbox = inbox(bus, WATCHED)
        self._patience = patience

    def follow(self, program: Program, until: float | None = None, bare: bool = False) -> None:
        """Draw on a Rerun program until it ends, Ctrl-C, or a simulated time [s]; a new run begins a new recording."""

        self.stop.listen()

        def closed() -> bool:
            return program.process.poll() is not None

        def finished(drawing: Drawing) -> bool:
            return closed() or (until is not None and (drawing.seconds >= until or drawing.over))

        while not self.stop() and not closed():
            manifest = self._manifest(lambda: self.stop() or closed())
            if manifest is None:
                return
            self._draw(Drawing(connected(program, APPLICATION), manifest, bare), finished, PERIOD)
            if until is not None:
                return

    def write(self, path: Path) -> None:
        """Draw into a Rerun file until the plant ends or Ctrl-C.

        The file gets no index, for which Rerun would keep a line for every batch in memory until the end.
        """
        os.environ.setdefault("RUST_LOG", UNINDEXED)  # read when Rerun is imported
        import rerun as rr

        if path.suffix != ".rrd":
            raise UsageError(f"{path}: Rerun knows its files by their ending; name it {path.with_suffix('.rrd')}")
        self.stop.listen()
        manifest = self._manifest(self.stop)
        if manifest is None:
            return
        stream = rr.RecordingStream(APPLICATION)
        try:
            stream.save(path, write_footer=False)
        except RuntimeError as error:
            raise UsageError(f"cannot write the view: {error}") from None
        self._draw(Drawing(stream, manifest, bare=False), lambda drawing: drawing.over, FILED)
        stream.disconnect()

    def _draw(self, drawing: Drawing, finished: Callable[[Drawing], bool], apart: float) -> None:
        """Batches of one run, so many seconds apart, until another one begins."""
        free, drawn, given, waiting = True, time.monotonic(), 0.0, []
        while True:
            over = self.stop() or finished(drawing)
            time.sleep(PERIOD)
            free = free or _flushed(drawing.stream, PERIOD)
            if free:
                waiting += self.inbox.take()
                over = over or _another(waiting, drawing.run_id)
            if free and (over or time.monotonic() >= drawn + apart):
                for part in parts(waiting, drawing.run_id):
                    drawing.add(part)
                    free = _flushed(drawing.stream, FLUSH)
                drawn, waiting = time.monotonic(), []
                if drawn >= given + FILED:  # a busy machine lets much wait at once, which the C library would keep
                    give_back()
                    given = drawn
            if over:
                return

    def _manifest(self, stopped: Callable[[], bool]) -> dict[str, Any] | None:
        """What the plant says of its run; None when somebody has stopped us meanwhile."""
        answer = self.bus.ask("scenario", self._patience, stopped)
        if answer is None and not stopped():
            raise RunError(
                f"no plant of rig {self.bus.rig_name!r} answers: start one first, or name the rig with --rig"
            )
        return None if answer is None else told_by(answer, self.bus.rig_name)


def _yield_to_all() -> None:
    """Draw, and Rerun with us, only where nobody else wants the processor.

    Not so Zenoh's threads and the guard, which are there already: what those leave on the wire, the plant would wait
    for, and the guard has to end Rerun on a busy machine too.
    """
    os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))


def parts(entries: list[Entry], run_id: int) -> Iterator[list[Entry]]:
    """The messages of a run in the order of their times, a few at once; a state before the profile of its tick."""
    own = sorted(
        (entry for entry in entries if run_of(entry) == run_id),
        key=lambda entry: (entry.log_time, entry.topic != "state"),
    )
    for begin in range(0, len(own), PART):
        yield own[begin : begin + PART]


def _another(entries: list[Entry], run_id: int) -> bool:
    """Has another run begun? Its states say so."""
    return any(entry.topic == "state" and run_of(entry) != run_id for entry in entries[-1000:])


def _flushed(stream: Any, patience: float) -> bool:
    """Has Rerun taken all that was sent?"""
    try:
        stream.flush(timeout_sec=patience)
    except RuntimeError:
        return False
    return True
