"""The command `hydrotwin`: one verb a file, grouped by what they are for."""

import sys

from bridge.cli.app import app


def main() -> None:
    """Run the command line; mistakes of the user get one line each and no traceback."""
    from bridge.cli import inspect, processes, running  # noqa: F401  they register their verbs
    from bridge.link import LinkError
    from bridge.plant_process import Failure
    from bridge.scenario import ScenarioError

    try:
        app()
    except ScenarioError as error:
        _complain(str(error))
        sys.exit(2)
    except (Failure, LinkError) as error:
        _complain(str(error))
        sys.exit(1)


def _complain(text: str) -> None:
    for line in text.splitlines():
        print(f"hydrotwin: {line}", file=sys.stderr)
