"""A recording in Rerun's viewer: a window, a page for a browser, a picture, or a file."""

from pathlib import Path

from bridge.errors import UsageError
from bridge.machine.process import Stop
from bridge.recording.reader import Recording, read
from bridge.recording.seen import instants, seen
from bridge.view.content import APPLICATION, send, write
from bridge.view.rerun_program import (
    Program,
    connected,
    require_rerun,
    server,
    until_closed,
    window,
)
from bridge.view.screenshot import screenshot
from controller.grid import NS

SHARE = 0.35  # of the run: where a picture is taken unless somebody says when


def show(
    file: Path, web: bool = False, save: Path | None = None, picture: Path | None = None, at: float = -1.0
) -> None:
    """Show a recording in Rerun, serve it to a browser until Ctrl-C, or write it or a picture of it and open nothing.

    at: the time [s] of the picture; negative for one of our choice.
    """
    if web + (save is not None) + (picture is not None) > 1:
        raise UsageError("--web serves a recording, --save and --screenshot write a file: choose one")
    require_rerun()
    recording = readable(file)
    if save:
        write(recording, save)
    elif picture:
        screenshot(picture, lambda program: _fill(program, recording, at))
    elif web:
        _serve(recording)
    else:
        _open(recording)


def readable(file: Path) -> Recording:
    """A recording with something to show."""
    recording = read(file)
    if not instants(recording):
        raise UsageError(f"{file}: the recording holds no state of a plant, so there is nothing to show")
    return recording


def _fill(program: Program, recording: Recording, at: float) -> float:
    send(connected(program, APPLICATION), recording, bare=True)
    stamps = seen(recording)["stamp"]
    return at if at >= 0.0 else SHARE * float(stamps[-1]) / NS


def _open(recording: Recording) -> None:
    """A window of its own; returns when it is closed."""
    with window() as program:
        send(connected(program, APPLICATION), recording)
        failed = until_closed(program, Stop().listen())
    if failed:
        raise UsageError("Rerun's window did not open; use --web for a browser, or --save FILE.rrd")


def _serve(recording: Recording) -> None:
    """A page on free ports of loopback, until Ctrl-C or another signal.

    The recording is sent to the server: given a file to load, it would keep a core busy for as long as it runs.
    """
    with server() as program:
        send(connected(program, APPLICATION), recording)
        stop = Stop().listen()  # before the address is told: whoever reads it may end us at once
        print(f"{program.address}\nCtrl-C ends it", flush=True)
        if until_closed(program, stop) is not None:
            raise UsageError("Rerun's web server ended by itself")
