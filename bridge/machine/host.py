"""Facts about the machine and the versions, for the recording and for people."""

import os
import platform
import sys
from importlib.metadata import PackageNotFoundError
from pathlib import Path

from twin.cache_folder import version

PACKAGES = ("hydrotwin", "numpy", "numba", "scipy", "eclipse-zenoh", "mcap", "rosbags", "control", "rerun-sdk")


def versions() -> dict[str, str]:
    """Version of each package we stand on; "absent" for one that is not installed."""
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "absent"
    return found


def cpu() -> str:
    """The processor's name, as the kernel tells it."""
    table = Path("/proc/cpuinfo")
    for line in table.read_text(encoding="utf-8", errors="replace").splitlines() if sys.platform == "linux" else []:
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def host() -> dict[str, str | int]:
    """The machine."""
    return {"system": platform.platform(), "processor": cpu(), "cores": os.cpu_count() or 1}
