"""The verb panel."""

import os
import sys
from typing import Annotated

import typer

from bridge.cli.options import CHANGES, CONFIG, CONNECT, PRIORITY
from bridge.errors import UsageError
from bridge.machine.priority import Priority
from bridge.wire.link import DEFAULT_ENDPOINT

DEFAULT = "square"  # it keeps moving
PORT = 8742


def panel(
    rig: Annotated[
        str | None,
        typer.Argument(help="Name of a rig that runs; without it the panel starts a run itself.", show_default=False),
    ] = None,
    scenario: Annotated[str, typer.Option(help="What to start: a built-in scenario, or a TOML file.")] = DEFAULT,
    changes: CHANGES = None,
    priority: PRIORITY = Priority.AUTO,
    host: Annotated[
        str, typer.Option(help="Address to serve at; other than this machine's it takes a token.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port to serve at; 0 for a free one.")] = PORT,
    watch: Annotated[bool, typer.Option("--watch", help="Nobody may operate: the page only shows.")] = False,
    opening: Annotated[bool, typer.Option("--open/--no-open", help="Open the page in this desktop's browser.")] = True,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
) -> None:
    """Watch and operate a rig from a page in the browser: live circuit, curves, numbers, faults, safety, health.

    Without RIG it starts plant and controller of a scenario, and ends them with itself; the page can stop them and
    start others. With RIG it joins a rig that runs. It is served on this machine alone; with --host it takes a token,
    of which there are two: one to operate, one to watch.
    """
    from bridge.panel.own_run import Wish
    from bridge.panel.server import serve
    from bridge.panel.station import Place
    from bridge.wire.link import Link

    if rig is None:
        from bridge.scenario import load

        load(scenario, changes)  # refused before anything is served
    elif changes or scenario != DEFAULT:
        raise UsageError(
            f"--scenario and --set are for a run that the panel starts; rig {rig!r} runs already: leave them out, or it"
        )
    wish = Wish(scenario, tuple(changes or ()), priority=priority)
    place = Place(rig, Link(None, connect, zenoh_config, 2.0), wish)
    serve(place, host, port, watch, lambda addresses: _tell(addresses, opening))


def _tell(addresses: list[str], opening: bool) -> None:
    for address in addresses:
        print(f"hydrotwin: panel at {address}", flush=True)
    print("hydrotwin: Ctrl-C ends it", flush=True)
    if opening and sys.stdout.isatty() and (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        import webbrowser

        webbrowser.open(addresses[0].split()[0])
