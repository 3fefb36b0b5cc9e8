"""Plant and recorder on one side of a network, the controller on the other, as three processes started by hand."""

import subprocess
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from bridge.recording.reader import Recording, read
from bridge.wire.messages import EventKind
from tests.support.processes import grown, started, wait_for

FLOWING = 20_000  # [bytes] of a recording whose run has begun


class Side(NamedTuple):
    """Where a process runs."""

    address: tuple[str, str]  # --listen or --connect, and the endpoint
    inside: tuple[str, ...] = ()  # what runs a command there


class Sides(NamedTuple):
    plant: Side
    recorder: Side
    controller: Side


def run_between(
    sides: Sides,
    path: Path,
    changes: list[str],
    meanwhile: Callable[[], None] = lambda: None,
    speed: float = 1.0,
    patience: float = 60.0,
) -> Recording:
    """A run of `step` in real time; meanwhile: called once the run has begun. All must end well, and in time."""
    pace = ("--speed", f"{speed:g}")
    own = tuple(word for change in changes for word in ("--set", change))
    commands = [
        (
            sides.plant,
            ("plant", "step", *own, *pace, "--await", "controller", "--await", "recorder", "--patience", "40"),
        ),
        (sides.recorder, ("record", "--output", str(path), "--patience", "40")),
        (sides.controller, ("controller", "step", *own, "--patience", "40")),
    ]
    with ExitStack() as stack:
        processes = [
            stack.enter_context(started(*words, *side.address, cwd=path.parent, inside=side.inside))
            for side, words in commands
        ]
        wait_for(lambda: grown(path, FLOWING) or processes[0].poll() is not None, patience)
        meanwhile()
        for process in processes:
            assert process.wait(patience) == 0, words_of(process)
    return read(path)


def spells(recording: Recording) -> list[tuple[float, float]]:
    """When the plant was in its safe state [s], after the first command."""
    found, since = [], None
    for event in recording.messages("event"):
        if event.kind == EventKind.SAFE:
            since = event.stamp / 1e9
        elif event.kind == EventKind.RESUMED and since is not None:
            found.append((since, event.stamp / 1e9))
            since = None
    return found


def words_of(process: subprocess.Popen[str]) -> str:
    """What it said last."""
    return process.stdout.read()[-3000:] if process.stdout else ""
