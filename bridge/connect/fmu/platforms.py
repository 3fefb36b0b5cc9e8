"""Machines that an FMU can run on: what LLVM makes code of for each, and who links it."""

import os
import shlex
import shutil
import sys
from importlib.util import find_spec
from typing import NamedTuple

from bridge.errors import UsageError, nearest


class Platform(NamedTuple):
    """One of them."""

    name: str  # of the command line
    triple: str  # of LLVM
    processor: str  # the oldest that it runs on
    folders: dict[str, str]  # in `binaries`, by version of FMI
    suffix: str  # of the library
    zig: str  # the same machine as zig calls it


PLATFORMS = {
    platform.name: platform
    for platform in (
        Platform(
            "x86_64-linux",
            "x86_64-unknown-linux-gnu",
            "x86-64",
            {"2": "linux64", "3": "x86_64-linux"},
            ".so",
            "x86_64-linux-gnu.2.17",
        ),
        Platform(
            "aarch64-linux",
            "aarch64-unknown-linux-gnu",
            "generic",
            {"2": "aarch64-linux", "3": "aarch64-linux"},
            ".so",
            "aarch64-linux-gnu.2.17",
        ),
        Platform(
            "x86_64-windows",
            "x86_64-pc-windows-gnu",
            "x86-64",
            {"2": "win64", "3": "x86_64-windows"},
            ".dll",
            "x86_64-windows-gnu",
        ),
    )
}


def here() -> str:
    """The platform of this machine, by its name."""
    return f"{os.uname().machine}-{sys.platform}"


def platforms(names: list[str]) -> list[Platform]:
    """Those of some names, or that of this machine. Raises UsageError for another one."""
    for name in names or [here()]:
        if name not in PLATFORMS:
            raise UsageError(
                f"--platform {name!r} is not a platform that an FMU can be made for{nearest(name, PLATFORMS)}"
            )
    return [PLATFORMS[name] for name in dict.fromkeys(names or [here()])]


def compiler_for(platform: Platform) -> list[str]:
    """The command that compiles and links for a platform. Raises UsageError where there is none."""
    if platform.name == here():
        command = shlex.split(os.environ.get("CC", "")) or ["cc"]
        found = shutil.which(command[0])
        if found is not None:
            return [found, *command[1:]]
        if not zig():
            raise UsageError(
                f"an FMU is linked by a C compiler, and there is no {command[0]!r} on this machine: install gcc or "
                "clang, or `pip install ziglang`"
            )
    if not (command := zig()):
        raise UsageError(
            f"an FMU for {platform.name} is linked by zig, which is not installed: `pip install ziglang` (400 MB)"
        )
    return [*command, "cc", "-target", platform.zig]


def zig() -> list[str]:
    """The command zig, by its path or as a package of Python."""
    if found := shutil.which("zig"):
        return [found]
    return [sys.executable, "-m", "ziglang"] if find_spec("ziglang") else []
