"""Verbs that show a run to people: view, report."""

from pathlib import Path
from typing import Annotated

import typer

from bridge.cli.options import AS_JSON, CONFIG, CONNECT, PATIENCE, there
from bridge.cli.outputs import print_json
from bridge.wire.link import DEFAULT_ENDPOINT

SHOWN = Annotated[
    Path | None,
    typer.Argument(help="A recording, .mcap; without one what runs now.", show_default=False),
]
SCREENSHOT = Annotated[
    Path | None, typer.Option("--screenshot", help="Write a picture of the view, .png, and open nothing.")
]


def view(
    file: SHOWN = None,
    web: Annotated[bool, typer.Option("--web", help="Serve it to a browser instead of opening a window.")] = False,
    save: Annotated[Path | None, typer.Option(help="Write a Rerun file, .rrd, and open nothing.")] = None,
    picture: SCREENSHOT = None,
    at: Annotated[
        str | None, typer.Option(help="Time of the picture, such as '1.2 s'. [default: a third of the run]")
    ] = None,
    rig: Annotated[str, typer.Option(help="Name of the rig to watch.")] = "rig",
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    patience: PATIENCE = 10.0,
) -> None:
    """Show a recording, or without FILE a running plant, in Rerun: the rig in 3-D, curves, maps of the pipes, events.

    Watching live: what a slow viewer cannot take is left out of the picture. Drawing takes processor time: where
    timing matters let the loop have SCHED_FIFO (hydrotwin doctor says whether it may), or watch from another machine.
    """
    from bridge.scenario.units import option

    when = -1.0 if at is None else option("at", at, "s")
    if file is not None:
        there(file)
        from bridge.view.show import show

        show(file, web, save, picture, when)
        return
    from bridge.view.live import LiveOptions, watch
    from bridge.wire.link import Link

    options = LiveOptions(web, save, picture, when if at is not None else None)
    watch(Link(None, connect, zenoh_config, patience), rig, options)


def report(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE...", help="Recordings, .mcap; several are laid over one another."),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="Page to write, .html.")] = Path("report.html"),
    as_json: AS_JSON = False,
) -> None:
    """Write one page on a run, to read offline and on paper; of several runs an overlay and their differences."""
    there(*files)
    from bridge.report.page import write_report

    written = write_report(files, output)
    if as_json:
        print_json({"report": str(written)})
    else:
        print(written)
