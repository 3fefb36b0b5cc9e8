"""The verb record, with all that can be said of what to keep."""

import time
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bridge.cli.options import (
    AS_JSON,
    CONFIG,
    CONNECT,
    MODE,
    PATIENCE,
    PRIORITY,
    ProcessMode,
    nanoseconds,
)
from bridge.cli.outputs import print_json
from bridge.errors import UsageError
from bridge.machine.priority import Priority
from bridge.wire.link import DEFAULT_ENDPOINT

if TYPE_CHECKING:
    from bridge.processes.recorder.run_file import Request

TRIGGERS = "late,refused,safe,degraded,latched,alarm"
TOPICS = Annotated[list[str] | None, typer.Option("--topics", help="Only these: 'state,pressure/*'. Repeatable.")]
WITHOUT = Annotated[list[str] | None, typer.Option("--without", help="Leave these out. Repeatable.")]


def record(
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="File to write. [default: runs/RIG-TIME.mcap]", show_default=False),
    ] = None,
    rig: Annotated[str, typer.Option(help="Name of the rig to record.")] = "rig",
    mode: MODE = ProcessMode.REALTIME,
    topics: TOPICS = None,
    without: WITHOUT = None,
    split_size: Annotated[str | None, typer.Option(help="Begin a new file after so much: '100 MB'.")] = None,
    split_time: Annotated[str | None, typer.Option(help="Begin a new file after so long: '60 s'.")] = None,
    ring: Annotated[str | None, typer.Option(help="Keep only the last '10 s' before a trigger.")] = None,
    after: Annotated[str, typer.Option(help="With --ring: how long to keep recording after a trigger.")] = "1 s",
    triggers: Annotated[
        str,
        typer.Option(
            help="With --ring: kinds of events, and signals past limits ('safe,p2 > 60 bar'); 'none' to save by query."
        ),
    ] = TRIGGERS,
    meta: Annotated[list[str] | None, typer.Option(metavar="KEY=VALUE", help="Extra metadata. Repeatable.")] = None,
    fsync: Annotated[bool, typer.Option("--fsync", help="Have each chunk on the disk itself: for power cuts.")] = False,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    patience: PATIENCE = 10.0,
    priority: PRIORITY = Priority.AUTO,
    as_json: AS_JSON = False,
) -> None:
    """Record everything on a rig's keys to an MCAP file until the plant ends.

    With --ring nothing is written until something happens: an event, a signal that goes past a limit, or a query to
    RIG/recorder/save.
    """
    from bridge.processes.recorder.process import run_recorder
    from bridge.recording.names import own_name
    from bridge.wire.link import Link

    request = _request(topics, without, (split_size, split_time, fsync), (ring, after, triggers), meta)
    default = Path("runs") / f"{rig}-{time.strftime('%Y%m%d-%H%M%S')}.mcap"
    link = Link(None, connect, zenoh_config, patience)
    with nullcontext(output) if output else own_name(default) as path:
        written = run_recorder(path, rig, link, mode == ProcessMode.LOCKSTEP, request, priority)
    if as_json:
        print_json({"recording": str(written[-1]) if written else None, "parts": [str(part) for part in written]})
    else:
        print("\n".join(f"hydrotwin: recorded {part}" for part in written) or "hydrotwin: no trigger, no file")


def _request(
    topics: list[str] | None,
    without: list[str] | None,
    files: tuple[str | None, str | None, bool],
    kept: tuple[str | None, str, str],
    meta: list[str] | None,
) -> "Request":
    from bridge.processes.recorder.parts import Keeping
    from bridge.processes.recorder.ring import Window
    from bridge.processes.recorder.run_file import Request
    from bridge.processes.recorder.triggers import split
    from bridge.recording.choice import choose
    from bridge.scenario.units import option
    from bridge.wire.messages import TOPICS as ALL

    size, seconds, fsync = files
    ring, after, triggers = kept
    keeping = Keeping(
        choose(ALL, topics, without) if topics or without else None,
        None if size is None else round(option("split-size", size, "byte", least=0.0)),
        None if seconds is None else nanoseconds("split-time", seconds),
        fsync,
    )
    window = None if ring is None else Window(nanoseconds("ring", ring), nanoseconds("after", after))
    kinds, conditions = split(triggers)
    return Request(keeping, window, kinds, conditions, tuple(_pair(text) for text in meta or []))


def _pair(text: str) -> tuple[str, str]:

    key, sign, value = text.partition("=")
    if not sign or not key:
        raise UsageError(f"--meta {text}: write KEY=VALUE, such as --meta operator=Ada")
    return key, value
