"""The priority of a process of the loop: what it asks for, what it gets, and how it gives it back."""

import ctypes
import os
import signal
import sys
from contextlib import suppress
from enum import StrEnum
from pathlib import Path

from bridge.machine.process import NOTE

MCL_CURRENT_AND_FUTURE = 3
FIFO_PRIORITY = 30
GREEDY = 1_000_000  # [us] of processor without a pause after which SCHED_FIFO is given back: others must live
EAGER = -10  # niceness of a recorder where the loop has SCHED_FIFO: what it has no time for is lost
YIELDING = 5  # niceness of who only listens, where the loop itself has ordinary priority
ORDINARY = "ordinary"


class Priority(StrEnum):
    """What a process asks for."""

    AUTO = "auto"  # SCHED_FIFO and locked memory in real time, where the system grants them and has two processors
    FIFO = "fifo"  # the same in any mode; what is refused is told
    ORDINARY = "ordinary"


def take(asked: Priority, is_paced: bool) -> str:
    """Take what is asked for, for every thread; returns in words what was granted.

    Call it when everything is compiled: a compiler at real-time priority would hold up the machine. is_paced: does the
    process follow a clock? Without one there is nothing to be late for.
    """
    if asked == Priority.ORDINARY or (asked == Priority.AUTO and not _is_wanted(is_paced)):
        return ORDINARY
    try:
        _schedule(os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, FIFO_PRIORITY)
    except (OSError, AttributeError) as error:
        if asked == Priority.FIFO:
            _tell(f"SCHED_FIFO refused ({error}): running at ordinary priority; run as root or raise `ulimit -r`")
        return ORDINARY
    _give_back_when_greedy()
    if ctypes.CDLL(None).mlockall(MCL_CURRENT_AND_FUTURE) == 0:
        return f"SCHED_FIFO {FIFO_PRIORITY}, memory locked"
    if asked == Priority.FIFO:
        _tell("mlockall refused: pages may be swapped; raise `ulimit -l` to get it")
    return f"SCHED_FIFO {FIFO_PRIORITY}"


def take_behind(asked: Priority, is_paced: bool) -> None:
    """Of a recorder: before all but the loop, where the loop takes SCHED_FIFO; else nicer than the loop.

    By its niceness, unless somebody has set that: SCHED_FIFO is for who must be punctual, and the kernel stops all who
    have it once they use 95 % of a processor together.
    """
    if asked == Priority.ORDINARY or not _is_wanted(is_paced) or not _is_granted() or not _renice(0, EAGER):
        stand_back()


def ease() -> None:
    """Of a recorder: back to ordinary niceness, for what has time: the summary of a long run."""
    _renice(EAGER, 0)


def stand_back() -> None:
    """Of a recorder, follower or panel: leave the processor to the loop where the loop cannot take it by SCHED_FIFO."""
    if not _is_granted():
        os.nice(YIELDING)


def _is_wanted(is_paced: bool) -> bool:
    return is_paced and _processors() > 1


def _is_granted() -> bool:
    """May this process have SCHED_FIFO, as then the loop may, too?"""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(FIFO_PRIORITY))
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    except (OSError, AttributeError):
        return False
    return True


def _renice(before: int, niceness: int) -> bool:
    """All threads, and the group that the kernel gives a session where that is ours; False where refused.

    Nothing is done where the niceness is another one than `before`: somebody has chosen it.
    """
    try:
        if os.getpriority(os.PRIO_PROCESS, 0) != before:
            return True
        for thread in Path("/proc/self/task").iterdir():
            with suppress(ProcessLookupError):
                os.setpriority(os.PRIO_PROCESS, int(thread.name), niceness)
        if os.getsid(0) == os.getpid() and Path("/proc/self/autogroup").exists():
            Path("/proc/self/autogroup").write_text(f"{niceness}", encoding="ascii")
    except (OSError, AttributeError):
        return False
    return True


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1


def _schedule(policy: int, priority: int) -> None:
    """All threads of this process: those of the middleware are there already.

    What they start is ordinary: a compiler that a law calls must neither hold up the machine nor be ended for that.
    """
    for thread in Path("/proc/self/task").iterdir():
        with suppress(ProcessLookupError):  # one that has ended meanwhile
            os.sched_setscheduler(int(thread.name), policy, os.sched_param(priority))


def _give_back_when_greedy() -> None:
    """The kernel tells of a thread that has not paused for GREEDY; a law that never returns must not stop a machine."""
    import resource

    signal.signal(signal.SIGXCPU, _give_back)
    hard = resource.getrlimit(resource.RLIMIT_RTTIME)[1]
    soft = GREEDY if hard == resource.RLIM_INFINITY else min(GREEDY, hard // 2)  # at the hard one it kills
    resource.setrlimit(resource.RLIMIT_RTTIME, (soft, hard))


def _give_back(*_: object) -> None:
    _schedule(os.SCHED_OTHER | os.SCHED_RESET_ON_FORK, 0)
    words = f"computed for {GREEDY / 1e6:g} s without a pause: SCHED_FIFO is given back, ordinary priority from here on"
    os.write(2, f"{NOTE}{words}\n".encode())


def _tell(words: str) -> None:
    print(f"{NOTE}{words}", file=sys.stderr, flush=True)
