"""Sweeps on a Dask cluster of real processes, killed in the middle and resumed: the same files, byte for byte."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from bridge.studies.sweep.engine import HERE, Crew, sweep

distributed = pytest.importorskip("distributed")
POINTS = [{"a": i, "b": 0.1 * i} for i in range(12)]
ABOUT = {"title": "slow squares"}
MAP = "map period gain --rig slow-sampling --x 80:200 --y 0.05:2 --cells 8 --runs 4"


def slow_square(point: Mapping[str, Any]) -> dict[str, float]:
    time.sleep(0.15)
    return {"square": point["a"] ** 2 + point["b"], "third": point["a"] / 3.0}


@contextmanager
def cluster(workers: int) -> Iterator[str]:
    """The address of a scheduler with worker processes."""
    options = {"processes": True, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(n_workers=workers, **options) as found:
        yield found.scheduler_address


def run_sweep(address: str, output: Path) -> None:
    """What the killed process does: a sweep, then its file."""
    found = sweep(slow_square, POINTS, ABOUT, output.with_suffix(".part"), Crew(0, address))
    output.write_text(json.dumps(found))


def start(*words: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, *words], env=os.environ, start_new_session=True)


def killed_after(part: Path, lines: int, process: subprocess.Popen[bytes]) -> None:
    """SIGKILL once so many lines of the journal are on disk."""
    end = time.monotonic() + 120.0
    while not part.is_file() or part.read_bytes().count(b"\n") < lines:
        assert process.poll() is None, "it was done before it could be killed"
        assert time.monotonic() < end
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL


@pytest.mark.parametrize("workers", [2, pytest.param(1, marks=[pytest.mark.endurance, pytest.mark.timeout(300)])])
def test_a_killed_sweep_on_a_cluster_resumes_to_the_same_file(workers: int, tmp_path: Path):
    output = tmp_path / "found.json"
    with cluster(workers) as address:
        code = f"import sys, pathlib, {__name__} as t; t.run_sweep(sys.argv[1], pathlib.Path(sys.argv[2]))"
        killed_after(output.with_suffix(".part"), 4, start("-c", code, address, str(output)))
        kept = output.with_suffix(".part").read_text().splitlines()
        assert 4 <= len(kept) < 1 + len(POINTS)
        begun = time.monotonic()
        run_sweep(address, output)
        assert time.monotonic() - begun < 0.15 * len(POINTS) + 60.0  # resumed, not waiting for the dead
    assert output.read_text() == json.dumps(sweep(slow_square, POINTS, ABOUT, None, HERE))
    assert not output.with_suffix(".part").exists()


@pytest.mark.endurance
@pytest.mark.timeout(1800)
def test_a_map_is_the_same_whoever_makes_it_and_whenever_it_was_killed(tmp_path: Path):
    """One process here; clusters of one and of two, killed after some of the runs and started again: four files."""
    command = ("-m", "bridge", *MAP.split(), "-o")
    assert start(*command, str(tmp_path / "alone" / "m"), "--workers", "1").wait() == 0
    expected = {path.name: path.read_bytes() for path in sorted((tmp_path / "alone").iterdir())}
    assert sorted(expected) == ["m-runs.csv", "m.csv", "m.html", "m.png"]
    for workers in (1, 2):
        output = tmp_path / f"of{workers}" / "m"
        with cluster(workers) as address:
            words = (*command, str(output), "--scheduler", address)
            killed_after(output.with_name("m.part"), 5, start(*words))
            assert start(*words).wait() == 0
        assert {path.name: path.read_bytes() for path in sorted(output.parent.iterdir())} == expected
