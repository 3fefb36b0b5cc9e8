"""The verb that says who is at a rig and how they are doing."""

from typing import Annotated

import typer

from bridge.cli.options import AS_JSON, CONFIG, CONNECT
from bridge.errors import RunError
from bridge.wire.link import DEFAULT_ENDPOINT


def status(
    rig: Annotated[str, typer.Argument(help="Name of the rig.")] = "rig",
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    as_json: AS_JSON = False,
) -> None:
    """Say who is at a rig that runs and how each is doing: plant, controller, recorder, follower.

    Of a follower: whether it knows the rig's state, how far it is behind, and with --health its verdict on the rig.
    """
    from bridge.cli.tuning import bus_of
    from bridge.machine.process import Stop
    from bridge.processes.statuses import statuses

    with bus_of(rig, connect, zenoh_config) as bus:
        found = statuses(bus, Stop().listen())
        if not found:
            raise RunError(
                f"nobody at rig {rig!r} says anything, {bus.place}: start a plant, or name it with --connect"
            )
    if as_json:
        from bridge.cli.outputs import print_json

        print_json([each._asdict() for each in found])
        return
    from bridge.cli.tables import print_table

    rows = [(each.role, str(each.pid), each.phase, _time(each.time), each.words) for each in found]
    print_table(("process", "pid", "phase", "t [s]", "says"), rows)


def _time(seconds: float | None) -> str:
    return "" if seconds is None else f"{seconds:.3f}"
