"""Verbs that open a rig to other people's tools: foxglove."""

from pathlib import Path
from typing import Annotated

import typer

from bridge.cli.options import CONFIG, CONNECT, PATIENCE
from bridge.wire.link import DEFAULT_ENDPOINT

RIG = Annotated[str, typer.Argument(help="Name of the rig.", metavar="RIG")]


def foxglove(
    rig: RIG = "rig",
    host: Annotated[str, typer.Option(help="Address to serve on; 0.0.0.0 is every one of this machine.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port to serve on; 0 is any that is free.")] = 8765,
    read_only: Annotated[bool, typer.Option("--read-only", help="Let nobody change anything through it.")] = False,
    layouts: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write layouts for Foxglove and PlotJuggler, and serve nothing."),
    ] = None,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    patience: PATIENCE = 10.0,
) -> None:
    """Serve a rig that runs, or a replay, to Foxglove: every topic, numbers that can change, services, the play bar.

    Needs the extra `foxglove`. Open the printed address in Foxglove; docs/foxglove.md says how.
    """
    if layouts is not None:
        from bridge.connect.layouts import write_layouts

        print("\n".join(map(str, write_layouts(rig, layouts))))
        return
    from bridge.connect.foxglove.serving import Serving, require_foxglove, serve
    from bridge.wire.link import Link

    require_foxglove()
    serve(Link(None, connect, zenoh_config, patience), rig, Serving(host, port, read_only))
