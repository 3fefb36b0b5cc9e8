"""Arguments and options that several verbs share."""

import re
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from bridge.errors import UsageError
from bridge.machine.priority import Priority
from bridge.wire.link import DEFAULT_ENDPOINT
from bridge.wire.messages import Mode

LONGEST = 1e6  # [s] of patience
PROTOCOL = re.compile(r"[a-z][a-z0-9-]*/.")
FILE = Annotated[Path, typer.Argument(help="A recording, .mcap.")]
TOPICS = Annotated[list[str] | None, typer.Option("--topics", help="Only these: 'state,pressure/*'. Repeatable.")]
TOLERANCE = Annotated[
    list[str] | None,
    typer.Option("--tolerance", metavar="SIGNAL=VALUE", help="Allowed difference: position='0.1 mm'. Repeatable."),
]


def address(param: typer.CallbackParam, value: str | None) -> str | None:
    """An address as Zenoh writes it. Raises UsageError for one without its protocol, with what may have been meant."""
    if value is None or PROTOCOL.match(value):
        return value
    host, colon, port = value.rpartition(":")
    if not colon:
        usual, _, port = DEFAULT_ENDPOINT.partition("/")[2].rpartition(":")
        host, port = (usual, value) if value.isdecimal() else (value or usual, port)
    raise UsageError(f"--{param.name} {value}: an address begins with its protocol: write tcp/{host}:{port}")


def seconds(param: typer.CallbackParam, value: float) -> float:
    """A number of seconds to wait. Raises UsageError for one that is not finite, or negative."""
    if not 0.0 <= value <= LONGEST:
        raise UsageError(f"--{param.name} {value:g}: seconds, from 0 to {LONGEST:g}")
    return value


def there(*paths: Path) -> None:
    """Raises UsageError for a file that is not there: verbs ask this before they import what reads it."""
    for path in paths:
        try:
            path.stat()
        except OSError as error:
            raise UsageError(f"{path}: {error.strerror}") from None


def tolerances(texts: list[str] | None) -> dict[str, str]:
    """Signal -> what may be. Raises UsageError for a text that is not such a pair."""

    pairs = [text.partition("=") for text in texts or []]
    for name, sign, value in pairs:
        if not sign or not value:
            raise UsageError(f"--tolerance {name}: write SIGNAL=VALUE, such as position='0.1 mm'")
    return {name: value for name, _, value in pairs}


class ProcessMode(StrEnum):
    """What paces a process of the loop."""

    LOCKSTEP = Mode.LOCKSTEP
    REALTIME = Mode.REALTIME


SCENARIO = Annotated[str, typer.Argument(help="Name of a built-in scenario, or a TOML file.")]
CHANGES = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a value of the scenario: controller.gain=0.4. Repeatable."),
]
MARK = Annotated[
    str | None,
    typer.Option("--mark", metavar="SCENARIO", help="Mark a scenario's rig on a dimensionless chart of stability."),
]
AS_JSON = Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")]
CONNECT = Annotated[str, typer.Option(help="Address of the plant or of a router.", callback=address)]
LISTEN = Annotated[
    str | None, typer.Option(help=f"Address to listen on.  [default: {DEFAULT_ENDPOINT}]", callback=address)
]
PATIENCE = Annotated[float, typer.Option(help="Seconds to wait for the plant to appear.", callback=seconds)]
JOIN = Annotated[str | None, typer.Option("--connect", help="Join a router instead of listening.", callback=address)]
CONFIG = Annotated[
    Path | None, typer.Option("--zenoh-config", help="Zenoh configuration file: TLS, passwords, access control.")
]
MODE = Annotated[ProcessMode, typer.Option(help="What paces the loop.")]
PRIORITY = Annotated[
    Priority,
    typer.Option(
        help="Priority of the loop's processes: auto takes SCHED_FIFO and locked memory in real time where granted."
    ),
]
QUIET = Annotated[bool, typer.Option("--quiet", help="Do not say on the terminal what happens.")]
WORKERS = Annotated[int, typer.Option(min=0, help="Processes for runs. [default: one per core]", show_default=False)]
SCHEDULER = Annotated[
    str | None, typer.Option(help="Address of a Dask scheduler to run on instead.", metavar="ADDRESS")
]


def nanoseconds(name: str, text: str) -> int:
    """A time that an option gives, such as "1.2 s" [ns]. Raises UsageError."""
    from bridge.scenario.units import option

    return round(option(name, text, "s", least=0.0) * 1e9)
