"""From what a plant or a controller has made to the file: compiled, linked, described and packed."""

import hashlib
import os
import subprocess
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

from bridge.connect.fmu.description import describe
from bridge.connect.fmu.made import Made
from bridge.connect.fmu.platforms import Platform, compiler_for
from bridge.connect.fmu.source import header
from bridge.errors import RunError, writing
from bridge.scenario import Scenario

OURS = Path(__file__).parent / "c"
LAW_HEADER = "hydrotwin_law.h"
EVERY = ("instance.c",)
HEADERS = ("model.h", "instance.h")
VERSIONS = {"2": ("fmi2.c",), "3": ("fmi3.c", "fmi3_absent.c")}
FLAGS = (  # no contraction: the same bits as the same arithmetic has in Python
    *("-std=gnu11", "-O2", "-fPIC", "-fvisibility=hidden", "-ffp-contract=off"),
    "-Werror=implicit-function-declaration",
)
PATIENCE = 300.0  # seconds; zig builds its library of C when it first links
PLAIN = {"LC_ALL": "C"}
EPOCH = (1980, 1, 1, 0, 0, 0)  # of the files within: the same FMU has the same bytes


def write_fmu(made: Made, scenario: Scenario, version: str, platforms: list[Platform], path: Path) -> None:
    """Write an FMU. Raises UsageError where there is no compiler, RunError where it or the disk fails."""
    compilers = [(platform, compiler_for(platform)) for platform in platforms]
    sources = dict(_sources(made, version))
    token = _token(made, sources)
    sources["data.h"] = header(made.variables, token, made.own_state, made.macros)
    identifier = f"hydrotwin_{made.kind}"
    files = {"modelDescription.xml": describe(made, scenario, version, identifier, token)}
    for platform, compiler in compilers:
        place = f"binaries/{platform.folders[version]}/{identifier}{platform.suffix}"
        files[place] = _linked(sources, made, compiler, platform)
    with writing(path), zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, EPOCH), content, zipfile.ZIP_DEFLATED)


def _sources(made: Made, version: str) -> Iterator[tuple[str, str]]:
    """All C files but data.h, by name."""
    for name in (*EVERY, *VERSIONS[version], *HEADERS, *made.ours, *made.headers):
        yield Path(name).name, (OURS / name).read_text(encoding="utf-8")
    for file in sorted((OURS / "fmi").glob(f"fmi{version}*.h")):
        yield f"fmi/{file.name}", file.read_text(encoding="utf-8")
    yield LAW_HEADER, (Path(__file__).parents[2] / "loop" / LAW_HEADER).read_text(encoding="utf-8")
    yield from made.sources.items()


def _token(made: Made, sources: dict[str, str]) -> str:
    """What tells this FMU from others: a hash of all it is made of."""
    content = hashlib.sha256(repr((sorted(sources.items()), made.variables, made.macros)).encode())
    for objects in made.objects.values():
        for name, code in objects.items():
            content.update(name.encode() + code)
    digest = content.hexdigest()
    return "{" + "-".join((digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32])) + "}"


def _linked(sources: dict[str, str], made: Made, compiler: list[str], platform: Platform) -> bytes:
    """The library of a platform."""
    objects = made.objects.get(platform.name, {})
    with tempfile.TemporaryDirectory(prefix="hydrotwin-fmu-") as work:
        folder = Path(work)
        (folder / "fmi").mkdir()
        for name, text in sources.items():
            (folder / name).write_text(text, encoding="utf-8")
        for name, code in objects.items():
            (folder / f"{name}.o").write_bytes(code)
        given = [*(name for name in sources if name.endswith(".c")), *(f"{name}.o" for name in objects)]
        folders = ["-I", ".", *(["-I", made.folder] if made.folder else [])]
        bound = ["-Wl,-Bsymbolic", "-Wl,-s"] if platform.suffix == ".so" else ["-Wl,-s"]
        _run([*compiler, *FLAGS, "-shared", *folders, "-o", "made", *given, *bound, "-lm"], folder)
        return (folder / "made").read_bytes()


def _run(command: list[str], folder: Path) -> None:
    try:
        done = subprocess.run(command, capture_output=True, env=os.environ | PLAIN, timeout=PATIENCE, cwd=folder)
    except subprocess.TimeoutExpired:
        raise RunError(f"the compiler did not link the FMU within {PATIENCE:g} s") from None
    except OSError as error:
        raise RunError(f"the compiler {command[0]} cannot be run: {error.strerror}") from None
    if done.returncode:
        said = done.stderr.decode("utf-8", "replace").splitlines()
        first = next((line for line in said if "error" in line), said[0] if said else f"exit code {done.returncode}")
        raise RunError(f"the FMU cannot be linked: {' '.join(first.split())}")
