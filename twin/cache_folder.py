"""Where compiled code is kept: in a folder named by a hash of the sources, the compilers and their options.

The user's choice (NUMBA_CACHE_DIR), the user's cache, or a private temporary folder, whichever can be used first.
"""

import hashlib
import os
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from importlib.metadata import distribution
from pathlib import Path

SOURCES = ("twin", "controller")
COMPILERS = ("numba", "llvmlite", "numpy")
OPTIONS = (
    "NUMBA_BOUNDSCHECK",
    "NUMBA_DEBUGINFO",
    "NUMBA_ENABLE_AVX",
    "NUMBA_LOOP_VECTORIZE",
    "NUMBA_OPT",
    "NUMBA_SLP_VECTORIZE",
)  # numba does not look at these when it loads compiled code


@cache
def fingerprint() -> str:
    """A hash of the sources, the compilers and their options."""
    digest = hashlib.sha256()
    root = Path(__file__).parents[1]
    for source in sorted(path for package in SOURCES for path in (root / package).rglob("*.py")):
        digest.update(f"{source.relative_to(root)}\n".encode())
        digest.update(source.read_bytes())
    compilers = [version(name) for name in COMPILERS]
    options = [os.environ.get(name, "") for name in OPTIONS]
    digest.update(repr((sys.implementation.cache_tag, compilers, options)).encode())
    return digest.hexdigest()[:16]


def version(package: str) -> str:
    """The version of an installed package, from the one line that says it. Raises PackageNotFoundError.

    `importlib.metadata.version` reads the whole description of the package as a mail.
    """
    lines = (distribution(package).read_text("METADATA") or "").splitlines()
    return next(line.partition(":")[2].strip() for line in lines if line.startswith("Version:"))


def cache_directory() -> Path | None:
    """The folder of exactly these sources, made if absent; None where nothing can be kept."""
    for folder in _choices():
        directory = folder / fingerprint()
        if _usable(directory):
            return directory
    return None


def is_lasting(directory: Path) -> bool:
    """Will it be there after a restart?"""
    return directory.parent != _temporary()


def _choices() -> Iterator[Path]:
    if chosen := os.environ.get("NUMBA_CACHE_DIR"):
        yield Path(chosen) / "hydrotwin"
    base, home = os.environ.get("XDG_CACHE_HOME", ""), os.path.expanduser("~")
    if os.path.isabs(base):
        yield Path(base) / "hydrotwin"
    elif os.path.isabs(home):
        yield Path(home) / ".cache" / "hydrotwin"
    with suppress(OSError):
        if _private(temporary := _temporary()):
            yield temporary


def _temporary() -> Path:
    return Path(tempfile.gettempdir()) / f"hydrotwin-{os.getuid()}"


def _private(folder: Path) -> bool:
    """Make it ours alone. What another user made, or can write to, is not used: compiled code is run."""
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & 0o022:
        return False
    folder.chmod(0o700)
    return True


def _usable(directory: Path) -> bool:
    """Can it be written, or does it hold something to read, as in an image that was made with compiled code?"""
    try:
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=directory).close()
    except OSError:
        with suppress(OSError):
            return any(directory.iterdir())
        return False
    return True
