"""Verbs of replay: replay itself, with and without --into, and its remote control."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from bridge.cli.options import AS_JSON, CONFIG, FILE, JOIN, LISTEN, TOLERANCE, nanoseconds, there, tolerances
from bridge.cli.outputs import print_json
from bridge.cli.record import TOPICS, WITHOUT
from bridge.errors import UsageError
from bridge.wire.link import DEFAULT_ENDPOINT


class Into(StrEnum):
    """What a recording is played into."""

    plant = "plant"
    controller = "controller"


INTO = Annotated[
    Into | None, typer.Option(help="Feed the recording to the twin or a controller and compare its output.")
]


def replay(
    file: FILE,
    into: INTO = None,
    speed: Annotated[str, typer.Option(help="Recorded seconds per second, or max.")] = "1",
    loop: Annotated[bool, typer.Option("--loop", help="Begin again at the end.")] = False,
    start: Annotated[str | None, typer.Option(help="From here on: '1.2 s'.")] = None,
    end: Annotated[str | None, typer.Option(help="Up to here.")] = None,
    topics: TOPICS = None,
    without: WITHOUT = None,
    remap: Annotated[list[str] | None, typer.Option(metavar="A:=B", help="Other keys: rig:=twin. Repeatable.")] = None,
    paused: Annotated[bool, typer.Option("--paused", help="Stand still at first.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Also on keys that have a live publisher.")] = False,
    wait: Annotated[float, typer.Option(help="Seconds to wait for a subscriber.")] = 0.0,
    listen: LISTEN = None,
    connect: JOIN = None,
    zenoh_config: CONFIG = None,
    changes: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="With --into: change the scenario.")
    ] = None,
    tolerance: TOLERANCE = None,
    alone: Annotated[bool, typer.Option("--alone", help="With --into: run in this process, without Zenoh.")] = False,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="With --into: recording of what comes out.")
    ] = None,
    as_json: AS_JSON = False,
) -> None:
    """Play a recording on the bus with its own timing; or --into the twin or a controller, and judge what comes out.

    Keys: space pauses and resumes, s steps, + and - change the speed, arrows seek, q quits; `hydrotwin remote` does the
    same from elsewhere. Exit code with --into: 1 when something differs by more than its tolerance.
    """
    there(file)
    if into is not None:
        _replay_into(file, into.value, (changes, tolerance, alone, listen, output), as_json)
        return
    from bridge.replay.player import speed_of
    from bridge.replay.republish import Playing
    from bridge.replay.republish import replay as play
    from bridge.wire.link import Link

    try:
        rate = speed_of(speed)
    except ValueError as error:
        raise UsageError(f"--speed: {error}") from None
    begin, stop = (None if t is None else nanoseconds(n, t) for n, t in (("start", start), ("end", end)))
    playing = Playing(rate, loop, begin, stop, topics, without, tuple(remap or ()), paused, force, wait)
    link = Link(listen or (None if connect or zenoh_config else DEFAULT_ENDPOINT), connect, zenoh_config, 10.0)
    status = play(file, link, playing)
    if as_json:
        print_json(status)
    else:
        print(f"hydrotwin: {status['sent']} messages sent, {status['left']} left, {status['loops']} loops ended")


def _replay_into(
    file: Path,
    into: str,
    words: tuple[list[str] | None, list[str] | None, bool, str | None, Path | None],
    as_json: bool,
) -> None:
    from bridge.cli.printing import print_differences
    from bridge.replay.through import Through, replay_through

    changes, tolerance, alone, listen, output = words
    path = output or file.with_stem(f"{file.stem}-into-{into}")
    verdict = replay_through(file, Through(into, path, tuple(changes or ()), tolerances(tolerance), alone, listen))
    further = {"events_differ": verdict.events_differ, "missing": verdict.missing, "output": str(verdict.output)}
    fed = "commands" if into == "plant" else "measurements"
    lack = f"the recording lacks {verdict.missing} {fed}: expect differences from them" if verdict.missing else ""
    print_differences(verdict.differences, as_json, further)
    if not as_json:
        print("\n".join(part for part in (verdict.events_differ, lack, f"residuals  {verdict.output}") if part))
    raise typer.Exit(0 if verdict.passed else 1)


def remote(
    verb: Annotated[str, typer.Argument(help="pause, resume, toggle, step, seek, skip, speed, faster, status, quit")],
    value: Annotated[
        str, typer.Argument(help="For seek a time ('1.2 s'), for skip seconds, for speed a number or max.")
    ] = "",
    rig: Annotated[str, typer.Option(help="Name of the rig.")] = "rig",
    connect: Annotated[str, typer.Option(help="Address of the replay or of a router.")] = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    as_json: AS_JSON = False,
) -> None:
    """Control a replay that runs, from anywhere: prints where it stands then."""
    from bridge.replay.remote import ask
    from bridge.wire.bus import Bus
    from bridge.wire.link import Link

    with Bus(Link(None, connect, zenoh_config, 2.0), rig, "operator", blocking=True) as bus:
        status = ask(bus, verb, value)
    if as_json:
        print_json(status)
    else:
        print(", ".join(f"{name} {value}" for name, value in status.items()))
