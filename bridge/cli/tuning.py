"""Verbs about a rig that runs: get, set, watch."""

import json
import time
from typing import Annotated, Any

import typer

from bridge.cli.options import AS_JSON, CONFIG, CONNECT
from bridge.cli.outputs import json_text, print_json
from bridge.errors import RunError, UsageError
from bridge.wire.link import DEFAULT_ENDPOINT

RIG = Annotated[str, typer.Argument(help="Name of the rig.", metavar="RIG")]
PATIENCE = 5.0  # seconds for an answer
WIDTH = 10  # of a column
HEADED = 20  # lines under a head


def get(
    rig: RIG = "rig",
    names: Annotated[list[str] | None, typer.Argument(help="Such as controller.gain; none for all.")] = None,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    as_json: AS_JSON = False,
) -> None:
    """Print numbers that can change while a rig runs: their values now, units and limits."""
    from bridge.cli.tables import print_table

    with bus_of(rig, connect, zenoh_config) as bus:
        found = asked(bus, "parameters", json.dumps(names).encode() if names else b"")
    if as_json:
        print_json(found)
        return
    rows = [
        (entry["name"], f"{entry['value']:g}", entry["unit"], _limits(entry), entry["description"])
        for entry in found["parameters"]
    ]
    print_table(("number", "now", "", "limits", ""), rows)


def set_(
    rig: RIG,
    changes: Annotated[list[str], typer.Argument(help="Such as controller.gain=1.5 or 'rig.load.force=500 N'.")],
    over: Annotated[str, typer.Option(help="A ramp that takes so long, such as '1 s'.")] = "0 s",
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    as_json: AS_JSON = False,
) -> None:
    """Change numbers of a rig that runs, all of them or none; the recording keeps each change with its instant."""
    wanted = {"set": dict(map(pair, changes)), "over": over}
    with bus_of(rig, connect, zenoh_config) as bus:
        found = asked(bus, "parameters/set", json.dumps(wanted).encode())
    if as_json:
        print_json(found)
        return
    for name, value in found["set"].items():
        shown = f"{value:g} {found['units'][name]}".rstrip()
        print(f"hydrotwin: {name} = {shown} from {found['apply_at'][name] / 1e9:g} s on")


def watch(
    rig: RIG = "rig",
    names: Annotated[list[str] | None, typer.Argument(help="Numbers to show beside the signals.")] = None,
    every: Annotated[float, typer.Option(min=0.05, help="Seconds from line to line.")] = 0.5,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    as_json: AS_JSON = False,
) -> None:
    """Show position, reference, pressures and valve of a rig that runs, and numbers that can change, until it ends."""
    from bridge.machine.process import Stop
    from bridge.processes.watching import Watching

    with bus_of(rig, connect, zenoh_config) as bus:
        listed = json.dumps(names or []).encode()
        asked(bus, "parameters", listed)
        watching, stop = Watching(bus), Stop().listen()
        due, lines = time.monotonic(), 0
        while not stop() and not watching.ended:
            time.sleep(0.02)
            if time.monotonic() >= due and (row := watching.row()):
                due = time.monotonic() + every
                values = asked(bus, "parameters", listed)["parameters"] if names else []
                _print_row(row | {entry["name"]: entry["value"] for entry in values}, as_json, lines % HEADED == 0)
                lines += 1


def _print_row(row: dict[str, float], as_json: bool, headed: bool) -> None:
    if as_json:
        print(json_text(row, None), flush=True)
        return
    if headed:
        print(" ".join(f"{name:>{WIDTH}}" for name in row))
    print(" ".join(f"{value:{max(WIDTH, len(name))}.4g}" for name, value in row.items()), flush=True)


def pair(change: str) -> tuple[str, Any]:
    """Name and value of "name=value", a number if it is one. Raises UsageError."""
    name, sign, text = change.partition("=")
    if not sign or not name.strip() or not text.strip():
        raise UsageError(f"{change!r} is not a change; write name=value, such as controller.gain=1.5")
    try:
        return name.strip(), float(text)
    except ValueError:
        return name.strip(), text.strip()


def bus_of(rig: str, connect: str, config: Any) -> Any:
    """A bus of an operator. Raises LinkError."""
    from bridge.wire.bus import Bus
    from bridge.wire.link import Link

    return Bus(Link(None, connect, config, 2.0), rig, "operator", blocking=True)


def asked(bus: Any, name: str, payload: bytes) -> dict[str, Any]:
    """What the plant answers. Raises RunError where there is none, UsageError for what it refuses."""
    answer = bus.request(name, payload, PATIENCE)
    if answer is None:
        raise RunError(
            f"no plant of rig {bus.rig_name!r} answers, {bus.place}: start one, or name it with --connect; access "
            "control may also keep the question from it"
        )
    found = json.loads(answer)
    if "refused" in found:
        raise UsageError(found["refused"])
    return found


def _limits(entry: dict[str, Any]) -> str:
    limits = entry["low"], entry["high"]
    return "" if limits == (None, None) else " .. ".join("" if limit is None else f"{limit:g}" for limit in limits)
