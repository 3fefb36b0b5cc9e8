"""`hydrotwin doctor`: what this machine has, and how punctually it can run the loop."""

import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from bridge.machine.host import cpu, versions
from bridge.machine.priority import FIFO_PRIORITY
from bridge.machine.punctuality import (
    Assessment,
    loopback,
    pacing,
    sleeping,
)
from bridge.wire.link import DEFAULT_ENDPOINT
from twin.cache_folder import cache_directory, is_lasting

OPTIONAL = {"rerun-sdk", "hydrotwin"}  # our own name is missing when we run from the sources
ROOM_FAIR, ROOM_BAD = 1e9, 1e8  # [bytes] an hour at 1 kHz takes about 0.9 GB; 100 MB hold 7 minutes
WRITTEN = 20_000_000  # [bytes]
SPEED_FAIR = 10e6  # [bytes/s] a run at 5 kHz writes 1.3 MB/s and flushes it four times a second
MOST_SECONDS = 1.0  # for writing
FIFO_PROBE = f"import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param({FIFO_PRIORITY}))"
LOCK_PROBE = "import ctypes, sys; sys.exit(ctypes.CDLL(None).mlockall(3) and 'refused')"
COLD = "the first start compiles for about 10 s; `hydrotwin run step --mode inprocess` does it beforehand"


class Finding(NamedTuple):
    """What one look found."""

    state: str  # good, fair: works, but look at the advice; bad: a run would fail
    what: str
    found: str
    advice: str  # empty when good


def examine() -> list[Finding]:
    """Look at everything; takes some 4 s. A look that cannot be had is a finding too."""
    return [_tried(what, look) for what, look in LOOKS.items()]


def _tried(what: str, look: Callable[[], Assessment]) -> Finding:
    try:
        state, found, advice = look()
    except (OSError, ValueError, AttributeError, subprocess.SubprocessError) as error:
        state, found = "fair", f"could not be examined: {error}"
        advice = "a run may still work: try `hydrotwin run step`"
    return Finding(state, what, found, "" if state == "good" else advice)


def packages() -> Assessment:
    """Are those that a run needs installed?"""
    needed = {name: version for name, version in versions().items() if name not in OPTIONAL}
    absent = [name for name, version in needed.items() if version == "absent"]
    found = ", ".join(f"{name} {version}" for name, version in needed.items())
    return "bad" if absent else "good", found, f"pip install {' '.join(absent)}"


def viewer() -> Assessment:
    """Is Rerun there?"""
    version = versions()["rerun-sdk"]
    return "fair" if version == "absent" else "good", f"rerun-sdk {version}", "pip install 'hydrotwin[view]'"


def processor() -> Assessment:
    """Enough cores, and are they free? Plant and controller each want one while they answer one another."""
    cores, load = len(os.sched_getaffinity(0)), os.getloadavg()[0]
    found = f"{cpu()}, {cores} core{'s' * (cores != 1)}, load {load:.1f}"
    if cores == 1:
        return "fair", found, "plant and controller share one core: expect late commands; lockstep stays exact"
    return "fair" if load > cores else "good", found, "other programs keep the cores busy: end them before timing runs"


def fifo() -> Assessment:
    """May a process of ours run at real-time priority? Tried in one that ends at once."""
    return _permission(
        FIFO_PROBE, f"for punctual ticks run as root, or allow `ulimit -r {FIFO_PRIORITY}` (rtprio in limits.conf)"
    )


def locked_memory() -> Assessment:
    """May a process of ours keep its pages in memory? Tried in one that ends at once."""
    advice = "for punctual ticks run as root, or allow `ulimit -l unlimited` (memlock in limits.conf)"
    return _permission(LOCK_PROBE, advice)


def _permission(probe: str, advice: str) -> Assessment:
    refused = subprocess.run([sys.executable, "-I", "-c", probe], capture_output=True, timeout=5.0).returncode
    return "fair" if refused else "good", "refused" if refused else "allowed", advice


def port() -> Assessment:
    """Is the plant's usual address free?"""
    host, _, number = DEFAULT_ENDPOINT.partition("/")[2].rpartition(":")
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, int(number)))
        except OSError as error:
            advice = "something listens there: name another address with --listen and --connect"
            return "fair", f"{DEFAULT_ENDPOINT}: {error.strerror}", advice
    return "good", f"{DEFAULT_ENDPOINT} is free", ""


def disk() -> Assessment:
    """Room and speed where runs/ is, or would be."""
    folder = next(path for path in (Path("runs").absolute(), *Path("runs").absolute().parents) if path.is_dir())
    room = shutil.disk_usage(folder).free
    try:
        speed = _write_speed(folder)
    except OSError as error:
        return "bad", f"{folder}: {error.strerror}", "record elsewhere: --record FILE.mcap"
    state = "bad" if room < ROOM_BAD else "fair" if room < ROOM_FAIR or speed < SPEED_FAIR else "good"
    return state, f"{room / 1e9:.1f} GB free, {speed / 1e6:.0f} MB/s", "free some room, or record elsewhere: --record"


def _write_speed(folder: Path) -> float:
    """Bytes per second that reach the disk."""
    start, done, block = time.perf_counter(), 0, os.urandom(WRITTEN // 10)
    with tempfile.TemporaryFile(dir=folder) as file:
        while done < WRITTEN and time.perf_counter() - start < MOST_SECONDS:
            done += file.write(block)
            os.fsync(file.fileno())
    return done / (time.perf_counter() - start)


def compile_cache() -> Assessment:
    """Where compiled code is kept, and is it there already?"""
    folder = cache_directory()
    if folder is None:
        return "fair", "cannot be kept: every start compiles", "set XDG_CACHE_HOME to a folder that can be written"
    files = [path for path in folder.rglob("*") if path.is_file()]
    found = f"{folder}: {sum(path.stat().st_size for path in files) / 1e6:.1f} MB"
    if not is_lasting(folder):
        return (
            "fair",
            found,
            "the user's cache cannot be written: set XDG_CACHE_HOME to a folder that outlives a restart",
        )
    return "good" if any(path.suffix == ".nbc" for path in files) else "fair", found, COLD


LOOKS: dict[str, Callable[[], Assessment]] = {
    "packages": packages,
    "viewer": viewer,
    "processor": processor,
    "SCHED_FIFO": fifo,
    "locked memory": locked_memory,
    "ticks at 1 kHz": pacing,
    "sleep alone": sleeping,
    "loopback round trip": loopback,
    "address": port,
    "disk": disk,
    "compiled code": compile_cache,
}
