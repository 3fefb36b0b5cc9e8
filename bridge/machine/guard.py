"""A program that ends what another process has started once that process is gone, however it went.

    python -I -S guard.py TOKEN GRACE

Standard input is a pipe that the guarded process holds open, so the system closes it at every kind of end. Then all
processes with TOKEN in their environment, which every child hands on to its own, get SIGTERM, and SIGKILL after GRACE
seconds. It is run by its path and imports only what Python has loaded anyway: it must be up before the first child.
"""

import os
import signal
import sys
import time

VARIABLE = "HYDROTWIN_GUARDS"  # of the environment: tokens of all guards that a process has, by ":"
IN_ORDER = b"."  # written before the pipe is closed: nothing is being started
SETTLE = 1.0  # [s] without a find after any other end: a child may have been between fork and exec
HOPELESS = 10.0  # [s] after the first SIGKILL
LOOK = 0.02  # [s] between two looks


def main(token: str, grace: float) -> None:
    """Wait for the end, then see to it that nothing is left."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
        signal.signal(number, signal.SIG_IGN)
    in_order = os.read(0, 1) == IN_ORDER
    end_marked(token, grace, 0.0 if in_order else SETTLE)


def end_marked(token: str, grace: float, settle: float) -> None:
    """End all processes with a token; done when none has been seen for `settle` seconds."""
    begun = seen = time.monotonic()
    told: set[int] = set()
    while (now := time.monotonic()) < begun + grace + HOPELESS:
        left = marked(token)
        if not left and now - seen >= settle:
            return
        seen = now if left else seen
        for pid in left:
            _end(pid, now > begun + grace, told)
        time.sleep(LOOK)


def marked(token: str) -> list[int]:
    """Processes with a token in the environment that they were started with, those excepted that have ended."""
    wanted, found = token.encode(), []
    for name in os.listdir("/proc"):
        if not name.isdigit() or int(name) == os.getpid():
            continue
        try:
            with open(f"/proc/{name}/environ", "rb") as environment:
                if wanted in environment.read():
                    found.append(int(name))
        except OSError:
            continue  # gone meanwhile, or not ours
    return found


def _end(pid: int, at_once: bool, told: set[int]) -> None:
    """Ask a process to end, once, awake to hear it; or end it."""
    try:
        if at_once:
            os.kill(pid, signal.SIGKILL)
        elif pid not in told:
            told.add(pid)
            os.kill(pid, signal.SIGTERM)
            os.kill(pid, signal.SIGCONT)
    except OSError:
        return  # gone meanwhile


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
