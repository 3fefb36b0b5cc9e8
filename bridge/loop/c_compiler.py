"""A control law in a C file, compiled by the system's compiler, once for each text of it and of what it includes."""

import hashlib
import os
import re
import shlex
import shutil
import subprocess
import tempfile
from contextlib import suppress
from pathlib import Path

from bridge.errors import ScenarioError
from twin.cache_folder import cache_directory

HEADER = Path(__file__).with_name("hydrotwin_law.h")
FLAGS = (  # no contraction: the same numbers on every processor as the same arithmetic has in Python
    *("-O2", "-fPIC", "-ffp-contract=off", "-Werror=implicit-function-declaration"),
    *("-I", str(HEADER.parent)),
)
PATIENCE = 60.0  # seconds
PLAIN = {"LC_ALL": "C"}  # messages in English, without typographic quotes
ERROR = re.compile(r"\berror\b|undefined reference|undefined symbol", re.IGNORECASE)


def compiled(source: Path, label: str) -> bytes:
    """The shared library of a C file, from the cache where it is there. Raises ScenarioError."""
    compiler = _compiler(label)
    key = hashlib.sha256(_run([*compiler, *FLAGS, "-E", str(source)], source, label))
    key.update(repr((compiler, FLAGS, _stamp(compiler[0]))).encode())
    folder = cache_directory()
    kept = None if folder is None else folder / "laws" / f"{key.hexdigest()[:32]}.so"
    if kept is not None:
        with suppress(OSError):
            return kept.read_bytes()
    with tempfile.TemporaryDirectory(prefix="hydrotwin-law-") as work:
        file = Path(work, "law.so")
        _run([*compiler, *FLAGS, "-shared", "-o", str(file), str(source), "-lm"], source, label)
        content = file.read_bytes()
    if kept is not None:
        _keep(kept, content)
    return content


def _compiler(label: str) -> list[str]:
    command = shlex.split(os.environ.get("CC", "")) or ["cc"]
    found = shutil.which(command[0])
    if found is None:
        raise ScenarioError(
            f"{label}: there is no C compiler {command[0]!r} on this machine; install one (gcc or clang), "
            "or give a compiled library as controller.library"
        )
    return [found, *command[1:]]


def _stamp(compiler: str) -> tuple[str, int, int]:
    """What changes when another compiler is installed."""
    place = Path(compiler).resolve()
    return str(place), place.stat().st_size, place.stat().st_mtime_ns


def _run(command: list[str], source: Path, label: str) -> bytes:
    """What the compiler prints. Raises ScenarioError with its first error."""
    try:
        done = subprocess.run(command, capture_output=True, env=os.environ | PLAIN, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        raise ScenarioError(f"{label}: the compiler did not end within {PATIENCE:g} s") from None
    except OSError as error:
        raise ScenarioError(f"{label}: the compiler cannot be run: {error.strerror}") from None
    if done.returncode:
        said = done.stderr.decode("utf-8", "replace").replace(str(source), source.name).splitlines()
        first = next(filter(ERROR.search, said), said[0] if said else f"exit code {done.returncode}")
        raise ScenarioError(f"{label} does not compile: {' '.join(first.split())}")
    return done.stdout


def _keep(file: Path, content: bytes) -> None:
    """Whole or not at all; where nothing can be written it is compiled again the next time."""
    with suppress(OSError):
        file.parent.mkdir(mode=0o700, exist_ok=True)
        descriptor, part = tempfile.mkstemp(dir=file.parent)
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content)
        os.replace(part, file)
