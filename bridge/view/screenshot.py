"""A picture of the view without a screen."""

import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from bridge.errors import UsageError
from bridge.view.rerun_program import Program, headless
from bridge.view.timeline import TIMELINE

WIDTH, HEIGHT = 1800, 1080
PATIENCE = 20.0  # [s] for the viewer to have what it was sent
SETTLE = 1.5  # [s] for it to draw
GRAPHICS = "Rerun finds no graphics to draw with; on Debian and Ubuntu: apt-get install mesa-vulkan-drivers"


def screenshot(path: Path, fill: Callable[[Program], float | None]) -> Path:
    """A picture of what `fill` sends to the program, at the time [s] that it returns; None: at the latest.

    Raises UsageError with one line where it cannot be made.
    """
    check_target(path)
    with headless(WIDTH, HEIGHT) as program:
        try:
            client = _client(program)
            at = fill(program)
            _take(client, program, path, at)
        except (RuntimeError, ConnectionError, TimeoutError) as error:
            gone = program.process.poll() is not None
            raise UsageError(GRAPHICS if gone else f"no picture: {error}") from None
    return path


def check_target(path: Path) -> None:
    """Can a picture be written there?"""
    if path.suffix != ".png":
        raise UsageError(f"{path}: a screenshot is a .png; name it {path.with_suffix('.png')}")
    if not path.absolute().parent.is_dir():
        raise UsageError(f"cannot write {path}: there is no folder {path.parent}")


def _client(program: Program) -> Any:
    """The viewer's control, once it can draw; one that cannot ends at once."""
    from rerun.experimental import ViewerClient

    until = time.monotonic() + PATIENCE
    while time.monotonic() < until and program.process.poll() is None:
        with suppress(RuntimeError, ConnectionError):
            client = ViewerClient.connect(program.source)
            client.get_state()
            return client
        time.sleep(0.1)
    raise RuntimeError("Rerun does not answer")


def _take(client: Any, program: Program, path: Path, at: float | None) -> None:
    _await_data(client, program)
    if at is None:
        client.set_time(TIMELINE, play_state="following")
    else:
        client.set_time(TIMELINE, duration=at, play_state="paused")
    time.sleep(SETTLE)
    client.save_screenshot(str(path.absolute()))


def _await_data(client: Any, program: Program) -> None:
    """Wait until the viewer knows a time and no more comes."""
    until, seen = time.monotonic() + PATIENCE, ""
    while time.monotonic() < until:
        if program.process.poll() is not None:
            raise RuntimeError("Rerun ended")
        state = str(client.get_state().recordings)
        if TIMELINE in state and state == seen:
            return
        seen = state
        time.sleep(0.3)
    raise RuntimeError(f"Rerun did not take the data within {PATIENCE:g} s")
