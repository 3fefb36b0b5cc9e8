"""The doctor: every look gives a finding, advice comes with every complaint, and the process is left as it was."""

import itertools
import json
import os
import socket
import subprocess
import sys
from collections import namedtuple
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from bridge.machine import doctor, punctuality
from bridge.machine.clock import SPIN_NS, Tick
from bridge.machine.doctor import LOOKS, Finding, examine
from bridge.scenario.model import RealTime
from bridge.wire.link import LinkError
from controller.grid import NS

ROOT = Path(__file__).parents[2]
MS = 1_000_000
Usage = namedtuple("Usage", "total used free")


@pytest.fixture
def swift(monkeypatch: pytest.MonkeyPatch) -> None:
    """Measure for a moment only."""
    monkeypatch.setattr(punctuality, "TICKS", 20)
    monkeypatch.setattr(punctuality, "TRIPS", 10)
    monkeypatch.setattr(doctor, "WRITTEN", 100_000)


@pytest.mark.usefixtures("swift")
def test_every_look_is_a_finding_and_every_complaint_has_advice():
    findings = examine()
    assert [finding.what for finding in findings] == list(LOOKS)
    for finding in findings:
        assert finding.state in ("good", "fair", "bad")
        assert finding.found
        assert bool(finding.advice) == (finding.state != "good"), finding


@pytest.mark.usefixtures("swift")
def test_a_look_that_cannot_be_had_is_a_finding(monkeypatch: pytest.MonkeyPatch):
    def fail() -> tuple[str, str, str]:
        raise OSError("no such thing here")

    monkeypatch.setattr(doctor, "LOOKS", dict.fromkeys(LOOKS, fail))
    for finding in examine():
        assert finding.state == "fair"
        assert "no such thing here" in finding.found
        assert finding.advice


@pytest.mark.parametrize(("missing", "look", "state"), [("rerun-sdk", "viewer", "fair"), ("numba", "packages", "bad")])
def test_absent_package_counts_as_it_is_needed(missing: str, look: str, state: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(doctor, "versions", lambda: {"numba": "1", "rerun-sdk": "1", "hydrotwin": "absent"})
    assert LOOKS[look]()[0] == "good"
    monkeypatch.setattr(doctor, "versions", lambda: {"numba": "1", "rerun-sdk": "1", missing: "absent"})
    assert LOOKS[look]()[0] == state
    assert "pip install" in LOOKS[look]()[2]


@pytest.mark.parametrize(("cores", "load", "state"), [(1, 0.0, "fair"), (2, 0.5, "good"), (2, 3.0, "fair")])
def test_one_core_or_a_busy_machine_is_fair(cores: int, load: float, state: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(cores)), raising=False)
    monkeypatch.setattr(os, "getloadavg", lambda: (load, 0.0, 0.0))
    assert doctor.processor()[0] == state


def test_probes_leave_the_process_as_it_was():
    def locked() -> int:
        lines = Path("/proc/self/status").read_text().splitlines()
        return next(int(line.split()[1]) for line in lines if line.startswith("VmLck"))

    before, locked_before = (os.sched_getscheduler(0), os.sched_getparam(0)), locked()
    assert {doctor.fifo()[0], doctor.locked_memory()[0]} <= {"good", "fair"}
    assert (os.sched_getscheduler(0), os.sched_getparam(0)) == before
    assert locked() <= locked_before


def test_a_right_refused_is_fair(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(doctor, "FIFO_PROBE", "raise PermissionError")
    assert doctor.fifo()[:2] == ("fair", "refused")
    assert "ulimit -r" in doctor.fifo()[2]


@pytest.mark.parametrize(
    ("late", "state"),
    [
        (0, "good"),
        (1, "fair"),
        (50, "fair"),  # of 1000 ticks, the share that a run allows
        (51, "bad"),
    ],
)
def test_clock_is_judged_by_the_overruns_a_run_allows(late: int, state: str, monkeypatch: pytest.MonkeyPatch):
    assert RealTime().overruns == punctuality.MOST_LATE
    assert RealTime().length * NS == punctuality.LONGEST_NS
    _fake_ticks(monkeypatch, [2 * MS] * late + [1_000] * (1000 - late))
    assert punctuality.pacing()[0] == state


@pytest.mark.parametrize(("lateness", "state"), [(SPIN_NS - 1, "good"), (SPIN_NS + 1, "fair"), (MS + 1, "bad")])
def test_sleep_must_wake_within_the_stretch_that_is_spun(lateness: int, state: str, monkeypatch: pytest.MonkeyPatch):
    _fake_ticks(monkeypatch, [lateness] * 1000)
    assert punctuality.sleeping()[0] == state


def _fake_ticks(monkeypatch: pytest.MonkeyPatch, lateness: list[int]) -> None:
    def ticks(period_ns: float, spin_ns: int) -> Iterator[Tick]:
        return (Tick(k, round(k * period_ns), late) for k, late in zip(itertools.count(1), lateness, strict=False))

    monkeypatch.setattr(punctuality, "ticks", ticks)


def test_round_trip_crosses_to_another_process_and_back():
    times = np.array(punctuality.round_trips(20))
    assert len(times) == 20
    assert np.median(times) > 5_000  # two crossings of the loopback cannot be quicker


@pytest.mark.parametrize(("trip", "state"), [(MS // 2, "good"), (2 * MS, "fair")])
def test_loopback_is_judged_by_the_daq_period(trip: int, state: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(punctuality, "round_trips", lambda count: [trip] * count)
    assert punctuality.loopback()[0] == state


def test_silent_loopback_is_bad(monkeypatch: pytest.MonkeyPatch):
    def fail(count: int) -> list[int]:
        raise LinkError("no message came back")

    monkeypatch.setattr(punctuality, "round_trips", fail)
    assert punctuality.loopback()[0] == "bad"


def test_address_is_free_or_taken(monkeypatch: pytest.MonkeyPatch):
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        monkeypatch.setattr(doctor, "DEFAULT_ENDPOINT", f"tcp/127.0.0.1:{listener.getsockname()[1]}")
        listener.listen()
        state, _, advice = doctor.port()
        assert state == "fair"
        assert "--listen" in advice
        assert "--connect" in advice
    assert doctor.port()[0] == "good"


@pytest.mark.parametrize(("free", "state"), [(5e9, "good"), (9e8, "fair"), (9e7, "bad")])
def test_little_room_is_fair_and_next_to_none_is_bad(
    free: float, state: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(doctor, "_write_speed", lambda folder: 1e8)
    monkeypatch.setattr(doctor.shutil, "disk_usage", lambda folder: Usage(1e10, 1e10 - free, free))
    assert doctor.disk()[0] == state


def test_disk_is_looked_at_without_leaving_anything(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(doctor, "WRITTEN", 100_000)
    doctor.disk()
    assert list(tmp_path.iterdir()) == []


def test_folder_that_cannot_be_written_is_bad(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def refuse(folder: Path) -> float:
        raise PermissionError(13, "Permission denied")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(doctor, "_write_speed", refuse)
    assert doctor.disk()[0] == "bad"


def test_compiled_code_is_cold_warm_or_temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    folder = tmp_path / "hydrotwin" / "0123"
    folder.mkdir(parents=True)
    monkeypatch.setattr(doctor, "cache_directory", lambda: folder)
    assert doctor.compile_cache()[0] == "fair"
    (folder / "circuit.step_once.nbc").write_bytes(b"index")
    assert doctor.compile_cache()[0] == "good"
    monkeypatch.setattr(doctor, "is_lasting", lambda folder: False)
    state, _, advice = doctor.compile_cache()
    assert state == "fair"
    assert "XDG_CACHE_HOME" in advice


def test_command_prints_findings_and_exits_by_the_worst():
    command = [sys.executable, "-m", "bridge", "doctor", "--json"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)
    findings = [Finding(**finding) for finding in json.loads(done.stdout)]
    assert done.returncode == (1 if any(finding.state == "bad" for finding in findings) else 0)
