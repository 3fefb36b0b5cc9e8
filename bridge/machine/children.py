"""Child processes: nothing in the working folder gets in their way, and they end with us, however we end."""

import os
import secrets
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from bridge.machine import guard

GRACE = 5.0  # [s] that children get to end in order
SOURCES = Path(__file__).parents[2]
_open: list[dict[str, str]] = []  # environments of the guards that watch over us now


def python(*arguments: str) -> list[str]:
    """The command for this Python with arguments, without the working folder in its search for modules."""
    return [sys.executable, "-P", *arguments]


@contextmanager
def guarded(grace: float = GRACE) -> Iterator[dict[str, str]]:
    """The environment for children: whoever is started with it is ended at the end of this, or when we are gone.

    grace: seconds from SIGTERM to SIGKILL. Foreign programs get it too, and hand it on to what they start. Inside
    another one it is that one's environment.
    """
    if _open:
        yield _open[-1]
        return
    token = secrets.token_hex(16)
    with _watched(token, grace) as pipe:
        _open.append(_environment(token))
        try:
            yield _open[-1]
        finally:
            _open.pop()
            with suppress(BrokenPipeError):
                os.write(pipe, guard.IN_ORDER)


@contextmanager
def _watched(token: str, grace: float) -> Iterator[int]:
    """A guard, and the pipe by which it knows that we are alive; it has seen to all when this ends."""
    command, quiet = [sys.executable, "-I", "-S", guard.__file__, token, str(grace)], subprocess.DEVNULL
    with subprocess.Popen(
        command, bufsize=0, stdin=subprocess.PIPE, stdout=quiet, stderr=quiet, start_new_session=True
    ) as keeper:
        assert keeper.stdin is not None
        yield keeper.stdin.fileno()


def _environment(token: str) -> dict[str, str]:
    """Ours, with the token beside those of guards that we are under ourselves."""
    outer = os.environ.get(guard.VARIABLE, "")
    own = os.environ | {guard.VARIABLE: f"{outer}:{token}" if outer else token, "PYTHONSAFEPATH": "1"}
    if sys.path[0] == str(SOURCES):  # run from the sources, in their folder: children do not look there
        own["PYTHONPATH"] = os.pathsep.join(filter(None, (str(SOURCES), own.get("PYTHONPATH"))))
    return own
