"""The command `hydrotwin`: one verb a function, grouped by what they are for."""

import sys


def main() -> None:
    """Run the command line; mistakes of the user get one line each and no traceback."""
    try:
        _run()
    except KeyboardInterrupt:
        _complain("interrupted")
        sys.exit(1)


def _run() -> None:
    from bridge.cli.verbs import app
    from bridge.failure import RunError
    from bridge.link import LinkError
    from bridge.scenario import ScenarioError

    try:
        app()
    except ScenarioError as error:
        _complain(str(error))
        sys.exit(2)
    except (RunError, LinkError) as error:
        _complain(str(error))
        sys.exit(1)


def _complain(text: str) -> None:
    for line in text.splitlines():
        print(f"hydrotwin: {line}", file=sys.stderr)
