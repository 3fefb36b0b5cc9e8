"""Verbs of the twin beside a rig: follow and whatif."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bridge.cli.options import AS_JSON, CHANGES, CONFIG, CONNECT, MODE, PATIENCE, QUIET, ProcessMode, there
from bridge.cli.outputs import given_up, print_json
from bridge.cli.streams import said_when_interrupted
from bridge.wire.link import DEFAULT_ENDPOINT
from bridge.wire.messages import Mode

if TYPE_CHECKING:
    from bridge.processes.listening import Heard
    from twin.estimation.health import Rules
    from twin.estimation.settings import Settings

WITHOUT = Annotated[
    list[str] | None,
    typer.Option(
        "--without",
        metavar="CHANNEL",
        help="A channel that is not used, such as p3; the table says how well it is found without. Repeatable.",
    ),
]
ENSEMBLE = "Twins in the ensemble, as many as the unknowns ask for at least: 23 for nine."
MEMBERS = Annotated[int, typer.Option(min=4, max=400, help=ENSEMBLE)]
FOLLOWERS = Annotated[
    int | None,
    typer.Option("--members", min=4, max=400, help=f"{ENSEMBLE} [default: 24; 28 with --health]", show_default=False),
]
EVERY = Annotated[int, typer.Option(min=1, max=1000, help="Scans between two corrections; each uses all of them.")]
HEALTH = Annotated[bool, typer.Option("--health", help="Say which fault the rig has, if any; see docs/health.md.")]
ALARMS = Annotated[
    float | None,
    typer.Option(
        "--alarms",
        min=1e-9,
        max=1000.0,
        help="With --health: false alarms per hour, at most. [default: 0.01]",
        show_default=False,
    ),
]
COMMISSIONING = Annotated[
    str | None,
    typer.Option(
        help="With --health: how long the rig is watched first, as one that is in order. [default: 30 s]",
        show_default=False,
    ),
]
OF_A_RIG = ("mode", "connect", "zenoh_config", "patience", "quiet", "listen_for")  # options that a recording has not


def follow(
    context: typer.Context,
    rig: Annotated[str, typer.Argument(help="Name of a rig that runs, or a recording, .mcap.", metavar="RIG|FILE")],
    changes: CHANGES = None,
    without: WITHOUT = None,
    members: FOLLOWERS = None,
    every: EVERY = 5,
    health: HEALTH = False,
    alarms: ALARMS = None,
    commissioning: COMMISSIONING = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="File to write, with a recording. [default: FILE-followed.mcap]", show_default=False
        ),
    ] = None,
    mode: MODE = ProcessMode.REALTIME,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    patience: PATIENCE = 10.0,
    quiet: QUIET = False,
    as_json: AS_JSON = False,
) -> None:
    """Estimate what no sensor reads: twins beside a rig or a recording, corrected by its measurements.

    Beside a rig the estimates, their standard deviations and the innovations go out on its keys `estimate` and
    `innovation`, until its plant ends; a recorder keeps them. Of a recording FILE-followed.mcap has them beside all
    that was in it. --set changes the scenario that the twins know of. --health adds the key `health`.
    """
    if not health:
        _refuse(context, ("alarms", "commissioning"), "is of --health, which is not asked for")
    if is_file(rig):
        _refuse(context, OF_A_RIG, f"is of a rig that runs, and {rig} is a recording")
    else:
        _refuse(context, ("output",), f"is of a recording; what is said of rig {rig!r} `hydrotwin record` keeps")
    from twin.estimation.settings import Settings

    rules = _rules(alarms, commissioning) if health else None
    if members is not None and rules is not None:
        _refuse_few(members)
    settings = Settings(members=members or Settings().members, every=every, without=tuple(without or ()))
    if is_file(rig):
        _follow_file(Path(rig), output, changes or [], settings, rules, as_json)
        return
    from bridge.processes.follower import run_follower
    from bridge.wire.link import Link

    link = Link(None, connect, zenoh_config, patience)
    done = run_follower(rig, link, Mode(mode), changes or [], settings, rules, quiet)
    if as_json:
        from bridge.loop.health import plain

        latest = None if done.latest is None else done.latest._asdict()
        print_json(done._asdict() | {"latest": latest, "health": None if done.health is None else plain(done.health)})
        return
    from bridge.cli.follow_printing import print_report

    print_report(done, rules, settings.without)


def _refuse(context: typer.Context, names: tuple[str, ...], why: str) -> None:
    """Raises UsageError for the first of some options that was given."""
    from bridge.errors import UsageError

    for name in names:
        source = context.get_parameter_source(name)
        if source is not None and source.name == "COMMANDLINE":
            raise UsageError(f"--{name.replace('_', '-')} {why}; leave it out")


def _rules(alarms: float | None, commissioning: str | None) -> "Rules":
    from bridge.cli.options import nanoseconds
    from bridge.errors import UsageError
    from twin.estimation.health import Rules

    rules = Rules() if alarms is None else Rules(alarms_per_hour=alarms)
    if commissioning is None:
        return rules
    looks, window = round(nanoseconds("commissioning", commissioning) / 1e9 / rules.look), rules.window * rules.look
    if looks < 3 * rules.window:
        raise UsageError(f"--commissioning {commissioning}: at least {3 * window:g} s, three windows of {window:g} s")
    return rules._replace(commissioning=looks)


def _refuse_few(members: int) -> None:
    from bridge.errors import UsageError
    from bridge.loop.health import FEWEST

    if members < FEWEST:
        raise UsageError(
            f"--members {members}: with --health at least {FEWEST}, for so many unknowns; leave it out, or give more"
        )


def is_file(name: str) -> bool:
    """Is a recording meant, and not a rig?"""
    return name.endswith(".mcap") or Path(name).is_file()


def _follow_file(
    file: Path, output: Path | None, changes: list[str], settings: "Settings", rules: "Rules | None", as_json: bool
) -> None:
    there(file)
    from bridge.cli.follow_printing import print_followed
    from bridge.replay.followed import follow_recording

    path = output or Path(f"{file.with_suffix('')}-followed.mcap")
    with said_when_interrupted(lambda: given_up(path)):
        done = follow_recording(file, path, changes, settings, rules)
    if as_json:
        print_json(done.plain())
    else:
        print_followed(done, rules)


def whatif(
    context: typer.Context,
    rig: Annotated[str, typer.Argument(help="Name of a rig that runs, or a recording, .mcap.", metavar="RIG|FILE")],
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="KEY=VALUE", help="Number of the controller or the reference to change: controller.gain=2."
        ),
    ] = None,
    horizon: Annotated[str, typer.Option(help="How far to look, such as '5 s'.")] = "5 s",
    expect: Annotated[
        list[str] | None,
        typer.Option("--expect", metavar="BAND", help="What must hold: 'limit cycle: none', 'peak p1 <= 90 bar'."),
    ] = None,
    risk: Annotated[float, typer.Option(min=0.0, max=1.0, help="Share of the futures that may break a band.")] = 0.05,
    at: Annotated[
        str | None, typer.Option(help="With a recording: from when on, such as '3 s'. [default: its end]")
    ] = None,
    listen_for: Annotated[
        str, typer.Option("--listen-for", help="With a rig: how long to follow it before, at least.")
    ] = "2 s",
    members: MEMBERS = 24,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    patience: PATIENCE = 10.0,
    as_json: AS_JSON = False,
) -> None:
    """Say what would happen if a number of the controller were changed now, from the present estimate.

    Each twin of the ensemble runs on with a controller of its own, faster than real time; their spread is what is not
    known of the rig. Exit code 1: a band is broken in more of the futures than --risk allows.
    """
    from bridge.cli.follow_printing import print_verdict
    from bridge.cli.options import nanoseconds
    from bridge.cli.streams import said_when_interrupted
    from bridge.cli.tuning import pair
    from bridge.replay.whatif import band_of, from_file, what_if
    from twin.estimation.settings import Settings

    if is_file(rig):
        _refuse(context, OF_A_RIG, f"is of a rig that runs, and {rig} is a recording")
    else:
        _refuse(context, ("at",), f"is of a recording, and {rig!r} is a rig that runs")
    ahead, settings, wanted = nanoseconds("horizon", horizon), Settings(members=members), dict(map(pair, changes or []))
    for text in expect or []:
        band_of(text)
    with said_when_interrupted(lambda: "interrupted; nothing was changed"):
        if is_file(rig):
            there(Path(rig))
            heard = from_file(Path(rig), None if at is None else nanoseconds("at", at), settings)
        else:
            heard = _heard(rig, (connect, zenoh_config, patience), listen_for, settings)
        verdict = what_if(heard, wanted, ahead, expect or [], risk)
    if as_json:
        print_json(verdict.plain())
    else:
        print_verdict(verdict)
    if not verdict.passed:
        raise typer.Exit(1)


def _heard(rig: str, where: tuple[Any, Any, float], listen_for: str, settings: "Settings") -> "Heard":
    """Of a rig that runs; where: its address, a configuration of Zenoh, and patience."""
    from bridge.cli.options import nanoseconds
    from bridge.processes.listening import listen
    from bridge.wire.link import Link

    return listen(rig, Link(None, *where), nanoseconds("listen-for", listen_for) / 1e9, settings)
