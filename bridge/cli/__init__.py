"""The command `hydrotwin`: one function per verb, grouped by what they are for."""

import logging
import signal
import sys


def main() -> None:
    """Run the command line; mistakes of the user get one line each and no traceback.

    Until a verb takes Ctrl-C into its own hands it ends the process at once: an exception raised in the middle of an
    import can get lost.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    from bridge.cli.verbs import app
    from bridge.errors import RunError, UsageError

    logging.basicConfig(format="hydrotwin: %(message)s", level=logging.WARNING)  # on standard error
    try:
        app()
    except UsageError as error:
        _complain(str(error))
        sys.exit(2)
    except RunError as error:
        _complain(str(error))
        sys.exit(1)


def _complain(text: str) -> None:
    for line in text.splitlines():
        print(f"hydrotwin: {line}", file=sys.stderr)
