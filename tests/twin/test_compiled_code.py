"""Compiled code on disk: found again, made anew where it is damaged, never taken from somebody else."""

import importlib.util
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest
from numba.core import event

from twin import cache_folder, kernel

SOURCE = """\
from twin.kernel import kernel


@kernel
def doubled(x):
    return 2.0 * x
"""
DRIVE = """\
from typing import NamedTuple

from twin.kernel import by_type, inlined, kernel


class Weight(NamedTuple):
    mass: float


class Spring(NamedTuple):
    stiffness: float


class Pump(NamedTuple):
    flow: float


class Drive(NamedTuple):
    pump: Pump
    load: Weight | Spring


@inlined
def delivered(pump):
    return 2.0 * pump.flow


@by_type
def held(load):
    raise TypeError(load)


@held.register
def weight(load: Weight):
    return 9.81 * load.mass


@held.register
def spring(load: Spring):
    return 0.1 * load.stiffness


@kernel
def step(drive):
    return delivered(drive.pump) + held(drive.load)
"""
DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda whole: b"",
    "cut": lambda whole: whole[: len(whole) // 2],
    "cut-by-a-byte": lambda whole: whole[:-1],
    "a-bit-flipped": lambda whole: whole[:100] + bytes([whole[100] ^ 1]) + whole[101:],
    "zeros": lambda whole: bytes(len(whole)),
    "text": lambda whole: b"not compiled code\n" * 10,
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own, and a module with one kernel beside it."""
    (tmp_path / "small.py").write_text(SOURCE, encoding="utf-8")
    (tmp_path / "drive.py").write_text(DRIVE, encoding="utf-8")
    monkeypatch.setattr(kernel, "FOLDER", tmp_path / "cache")
    return tmp_path


def imported(folder: Path, name: str = "small") -> ModuleType:
    """A module as a new process would have it: nothing compiled yet."""
    spec = importlib.util.spec_from_file_location(name, folder / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # where numba looks for it when it reads what was kept
    spec.loader.exec_module(module)
    return module


def hits(folder: Path) -> int:
    """How often a call was answered from disk, after it gave the right result."""
    doubled = imported(folder).doubled
    assert doubled(21.0) == 42.0
    return sum(doubled.compiled.stats.cache_hits.values())


def kept(folder: Path) -> list[Path]:
    return [path for path in (folder / "cache").rglob("*") if path.is_file()]


def test_a_second_process_finds_what_the_first_compiled(folder: Path):
    assert [hits(folder), hits(folder)] == [0, 1]
    assert len(kept(folder)) == 1


def compiled_for(folder: Path, kind: str, force: float) -> set[str]:
    """The functions that a new process compiles for a drive with a kind of load, when its step gives the right sum."""
    names: set[str] = set()
    drive = imported(folder, "drive")
    with event.install_recorder("numba:compile") as seen:
        assert drive.step(drive.Drive(drive.Pump(1.0), getattr(drive, kind)(10.0))) == pytest.approx(2.0 + force)
    for _, begun in seen.buffer:
        names.add(begun.data["dispatcher"].py_func.__name__)
    return names


def test_another_kind_in_a_slot_compiles_that_kind_and_the_step_alone(folder: Path):
    assert compiled_for(folder, "Weight", 98.1) == {"step", "delivered", "weight"}
    assert compiled_for(folder, "Spring", 1.0) == {"step", "spring"}
    assert compiled_for(folder, "Weight", 98.1) == set()


def test_python_calls_what_kernels_copy(folder: Path):
    """What is kept for copying has no way in from Python: a call of it makes another, and finds that one again."""
    compiled_for(folder, "Weight", 98.1)
    for _ in range(2):
        drive = imported(folder, "drive")
        assert drive.delivered(drive.Pump(1.5)) == 3.0


@pytest.mark.parametrize("how", DAMAGE)
def test_damaged_code_is_compiled_anew(folder: Path, how: str):
    hits(folder)
    (file,) = kept(folder)
    file.write_bytes(DAMAGE[how](file.read_bytes()))
    assert [hits(folder), hits(folder)] == [0, 1]


def test_code_of_another_signature_is_not_taken(folder: Path):
    """Two files exchanged: each says itself what it holds."""
    doubled = imported(folder).doubled
    assert (doubled(1.5), doubled(2)) == (3.0, 4.0)
    one, two = kept(folder)
    one.rename(folder / "third")
    two.rename(one)
    (folder / "third").rename(two)
    again = imported(folder).doubled
    assert (again(1.5), again(2)) == (3.0, 4.0)
    assert not again.compiled.stats.cache_hits


def test_a_disk_that_refuses_costs_a_compilation_and_leaves_nothing(folder: Path, monkeypatch: pytest.MonkeyPatch):
    def refuse(path: Path, data: bytes) -> int:
        path.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", refuse)
    assert [hits(folder), hits(folder)] == [0, 0]
    assert not kept(folder)


def test_a_folder_that_is_a_file_costs_a_compilation(folder: Path):
    (folder / "cache").write_text("x", encoding="utf-8")
    assert [hits(folder), hits(folder)] == [0, 0]


def test_processes_that_compile_at_one_time_leave_one_whole_file(folder: Path):
    """Each process gets the right result, and what they leave is found by the next one."""
    root = Path(__file__).parents[2]
    environment = os.environ | {"NUMBA_CACHE_DIR": str(folder / "cache"), "PYTHONPATH": f"{root}:{folder}"}
    command = [
        sys.executable,
        "-c",
        "import small; assert small.doubled(21.0) == 42.0; print(*small.doubled.compiled.stats.cache_hits.values())",
    ]
    running = [subprocess.Popen(command, env=environment) for _ in range(2)]
    assert [process.wait(timeout=100) for process in running] == [0, 0]
    last = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=100, check=True)
    assert len(kept(folder)) == 1
    assert last.stdout == "1\n"


@pytest.fixture
def closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """No cache but a temporary one."""
    (tmp_path / "file").touch()
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, str(tmp_path / "file"))
    monkeypatch.setattr(cache_folder.tempfile, "gettempdir", lambda: str(tmp_path))
    return tmp_path / f"hydrotwin-{os.getuid()}"


def test_the_users_choice_still_depends_on_the_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """numba does not notice that a component has changed which a kernel calls."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert cache_folder.cache_directory() == tmp_path / "hydrotwin" / cache_folder.fingerprint()


def test_a_closed_cache_gives_a_private_temporary_one(closed: Path):
    assert cache_folder.cache_directory() == closed / cache_folder.fingerprint()
    assert closed.stat().st_mode & 0o777 == 0o700
    assert not cache_folder.is_lasting(closed / cache_folder.fingerprint())


def test_a_user_without_a_home_gets_a_temporary_cache(closed: Path, monkeypatch: pytest.MonkeyPatch):
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name)
    monkeypatch.setattr(cache_folder.os.path, "expanduser", lambda path: path)
    assert cache_folder.cache_directory() == closed / cache_folder.fingerprint()


def test_a_temporary_folder_that_others_can_write_to_is_not_used(closed: Path):
    """Whoever can write there could have their code run."""
    closed.mkdir()
    closed.chmod(0o777)
    assert cache_folder.cache_directory() is None


def test_a_link_that_somebody_laid_is_not_followed(closed: Path, tmp_path: Path):
    (tmp_path / "elsewhere").mkdir()
    closed.symlink_to(tmp_path / "elsewhere")
    assert cache_folder.cache_directory() is None


def test_somebody_elses_temporary_folder_is_not_used(closed: Path, monkeypatch: pytest.MonkeyPatch):
    closed.mkdir(mode=0o700)
    stranger = os.getuid() + 1
    monkeypatch.setattr(cache_folder.os, "getuid", lambda: stranger)
    closed.rename(closed.with_name(f"hydrotwin-{stranger}"))
    assert cache_folder.cache_directory() is None


@pytest.mark.parametrize("name", cache_folder.OPTIONS)
def test_options_of_the_compiler_have_code_of_their_own(name: str, monkeypatch: pytest.MonkeyPatch):
    before = cache_folder.fingerprint.__wrapped__()
    monkeypatch.setenv(name, "7")
    assert cache_folder.fingerprint.__wrapped__() != before
