"""The application that the verbs register with, and options that several share."""

import json
from enum import StrEnum
from typing import Annotated, Any

import typer

HELP = """A digital twin of a hydraulic drive, and a testbed for its controllers.

Start with [bold]hydrotwin run step[/bold]: plant, controller and recorder run as three processes, and leave a
recording, a picture and a summary. [bold]hydrotwin scenarios[/bold] lists what else there is to run.
Exit codes: 0 good, 1 the run or a check failed, 2 wrong use.
"""

app = typer.Typer(help=HELP, no_args_is_help=True, rich_markup_mode="rich", pretty_exceptions_enable=False)


class Mode(StrEnum):
    """What paces the loop."""

    inprocess = "inprocess"
    lockstep = "lockstep"
    realtime = "realtime"


class ProcessMode(StrEnum):
    """What paces a process of the loop."""

    lockstep = "lockstep"
    realtime = "realtime"


SCENARIO = Annotated[str, typer.Argument(help="Name of a built-in scenario, or a TOML file.")]
CHANGES = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a value of the scenario: controller.gain=0.4. Repeatable."),
]
AS_JSON = Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")]
RUN, PROCESSES, LOOK = "Run", "Processes", "Look"


def print_json(value: Any) -> None:
    """Plain JSON on standard output."""
    print(json.dumps(value, indent=2))
