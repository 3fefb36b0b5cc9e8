"""The command `hydrotwin`: one function per verb, grouped by what they are for."""

import atexit
import gc
import os
import signal
import sys
import threading
from contextlib import suppress
from typing import NoReturn

from bridge.cli import streams

FEWER_SEARCHES = 50_000  # objects made between two searches for garbage: imports make many and leave hardly any


def main() -> NoReturn:
    """Run the command line and end the process, without the half second that Python takes to free what it has loaded.

    What was registered for the end is called, threads of ours are awaited, and what was written is out.
    """
    code = answer()
    for thread in threading.enumerate():
        if thread is not threading.current_thread() and not thread.daemon:
            thread.join()
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)


def answer() -> int:
    """Run the command line and return its exit code; mistakes of the user get one line each and no traceback.

    Until a verb takes Ctrl-C into its own hands it ends the process at once: an exception raised in the middle of an
    import can get lost.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    gc.set_threshold(FEWER_SEARCHES)
    streams.prepare()
    code, words = _outcome()
    if (refused := streams.refusal()) is not None:
        code, words = code or 1, refused
    streams.complain(words)
    return code


def _outcome() -> tuple[int, str]:
    """Exit code, and what there is to complain of."""
    from bridge.cli.verbs import app
    from bridge.errors import RunError, UsageError, reason

    streams.warn_on_error()
    try:
        app()
    except SystemExit as end:
        return (end.code, "") if isinstance(end.code, int) else (int(end.code is not None), str(end.code or ""))
    except UsageError as error:
        return 2, str(error)
    except RunError as error:
        return 1, str(error)
    except OSError as error:
        return 1, reason(error)
    return 0, ""
