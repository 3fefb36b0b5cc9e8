"""The application that the verbs register with, and options that several share."""

import json
from typing import Any

import typer

HELP = """A digital twin of a hydraulic drive, and a testbed for its controllers.

Start with [bold]hydrotwin run step[/bold]: plant, controller and recorder run as three processes, and leave a
recording, a picture and a summary. [bold]hydrotwin scenarios[/bold] lists what else there is to run.
Exit codes: 0 good, 1 the run or a check failed, 2 usage error.
"""

app = typer.Typer(help=HELP, no_args_is_help=True, rich_markup_mode="rich", pretty_exceptions_enable=False)


RUN, PROCESSES, LOOK = "Run", "Processes", "Look"


def print_json(value: Any) -> None:
    """Plain JSON on standard output."""
    print(json.dumps(value, indent=2))
