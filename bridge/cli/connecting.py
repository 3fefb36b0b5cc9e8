"""Verbs that open a rig to other people's tools: foxglove, ros."""

from pathlib import Path
from typing import Annotated

import typer

from bridge.cli.options import CONFIG, CONNECT, PATIENCE, address
from bridge.errors import UsageError
from bridge.wire.link import DEFAULT_ENDPOINT

DOMAIN = Annotated[int, typer.Option(min=0, max=232, envvar="ROS_DOMAIN_ID", help="Domain of the nodes.")]
ROS_ENDPOINT = "tcp/127.0.0.1:7448"  # beside the plant's own
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


def ros(
    rig: RIG = "rig",
    domain: DOMAIN = 0,
    router: Annotated[
        str | None, typer.Option(help="Address of a router of ROS 2 that is there, rmw_zenohd.", callback=address)
    ] = None,
    listen: Annotated[
        str,
        typer.Option(help="Without --router: address at which this process is the nodes' router.", callback=address),
    ] = ROS_ENDPOINT,
    package: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write the ament package hydrotwin_msgs there, and bridge nothing."),
    ] = None,
    scenario: Annotated[
        str | None, typer.Option(help="With --package: the scenario whose further channels have a message.")
    ] = None,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    patience: PATIENCE = 10.0,
) -> None:
    """Show a rig that runs, or a replay, to nodes of ROS 2 with rmw_zenoh, and take commands and settings from them.

    Needs no ROS. docs/ros.md says how to reach the rig, and how to write a controller as a node.
    """
    if scenario is not None and package is None:
        raise UsageError("--scenario says which further channels a package has: add --package FOLDER")
    if package is not None:
        from bridge.connect.ros.package import write_package
        from bridge.scenario import load
        from bridge.scenario.channels import layout_of

        layout = () if scenario is None else layout_of(load(scenario))
        print("\n".join(map(str, write_package(package, layout))))
        return
    from bridge.connect.ros.bridging import RosSide, bridge
    from bridge.wire.link import Link

    bridge(Link(None, connect, zenoh_config, patience), rig, RosSide(domain, router, listen))
