"""What an installation takes: `python -m tests.tools.sizes` prints the table of docs/how-to.md.

Every row is measured in a fresh venv, with the versions of requirements.lock: size on disk without pip, what was
compiled by pip included, and the processor time of an import, beyond that of the bare interpreter.
"""

import os
import re
import resource
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
RUNS = 5  # the least of so many counts; the first one fills the disk's cache
CORE = {"import hydrotwin": "import hydrotwin", "hydrotwin --version": "from bridge.cli import main; main()"}
IMPORTED = {  # what an extra brings
    "fmu": "import fmpy",
    "foxglove": "import foxglove",
    "gym": "import gymnasium",
    "logs": "import asammdf, h5py",
    "panel": "import starlette.applications, uvicorn, websockets",
    "parquet": "import pyarrow",
    "sweep": "import dask.distributed",
    "view": "import rerun",
}


def main() -> None:
    """The table, in Markdown."""
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    assert set(extras) == set(IMPORTED)
    with TemporaryDirectory() as folder:
        pins = Path(folder) / "pins.txt"
        lines = re.findall(r"^[\w.-]+==[^\\\n]+", (ROOT / "requirements.lock").read_text(), re.MULTILINE)
        pins.write_text("\n".join(lines))  # without hashes, which pip wants of a wheel of ours, too
        core, wheel = Path(folder) / "core", _wheel(Path(folder))
        subprocess.run([sys.executable, "-m", "venv", core], check=True)
        bare, nothing = _size(core), _cost(core, "pass")
        _install(core, pins, str(wheel))
        size = _size(core)
        print("| | on disk | CPU time |\n|---|---|---|")
        for words, code in CORE.items():
            _print(words, f"{(size - bare) / 1e6:.0f} MB", _cost(core, code) - nothing)
        for name, code in sorted(IMPORTED.items()):
            venv = Path(folder) / name
            shutil.copytree(core, venv, symlinks=True, copy_function=os.link)
            _install(venv, pins, f"{wheel}[{name}]")
            _print(f"`{name}`: {code}", f"+ {(_size(venv) - size) / 1e6:.0f} MB", _cost(venv, code) - nothing)
            shutil.rmtree(venv)


def _print(words: str, size: str, cost: float) -> None:
    print(f"| {words} | {size} | {1e3 * cost:.0f} ms |", flush=True)


def _wheel(folder: Path) -> Path:
    """Ours, as a user gets it."""
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", folder, ROOT]
    subprocess.run(command, check=True)
    return next(folder.glob("hydrotwin-*.whl"))


def _install(venv: Path, pins: Path, what: str) -> None:
    subprocess.run([venv / "bin" / "python", "-m", "pip", "install", "--quiet", "-c", pins, what], check=True)


def _size(venv: Path) -> int:
    """Bytes in files, as their names have them: on a file system with compression fewer are taken."""
    return sum(path.lstat().st_size for path in (venv / "lib").rglob("*") if path.is_file())


def _cost(venv: Path, code: str) -> float:
    """Processor time of a program [s], its start included."""
    return min(_once(venv, code) for _ in range(RUNS))


def _once(venv: Path, code: str) -> float:
    begun = resource.getrusage(resource.RUSAGE_CHILDREN)
    given = ["--version"] if "main()" in code else []
    subprocess.run([venv / "bin" / "python", "-c", code, *given], check=True, stdout=subprocess.DEVNULL, cwd=venv)
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime


if __name__ == "__main__":
    main()
