"""An hour in real time at 1 kHz with recorder and view, and a day of simulated time; each with a form of seconds."""

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from bridge.loop.exchange import exchange, sides
from bridge.recording.reader import read
from bridge.scenario import Scenario, load
from bridge.scenario.circuit import circuit_of
from bridge.wire.link import free_endpoint
from tests.support.processes import LOOSE, UNDRAWN, child, started
from tests.support.two_sides import words_of
from twin.cylinder import Cylinder

PERIOD = 4.0  # [s] of the scenario `sine`
FIFO = ("--priority", "fifo")
EDGES = np.array([-np.inf, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, np.inf])  # [ms] of lateness
SETTLED = 0.3  # share of the run after which memory is settled
GROWN = 8.0  # [MB] that a process may have more at the end than when it was settled, beside a share
SCANS = "loop.daq_period='10 ms'"  # one for each sample alone: the steps of the twin are those of every run
ROLES = ("plant", "controller", "record", "view")


class Memory(NamedTuple):
    """Resident memory of a process over a run."""

    settled: float  # [MB]
    end: float  # [MB]

    @property
    def flat(self) -> bool:
        """Has it stayed what it was?"""
        return self.end <= 1.05 * self.settled + GROWN


def resident(pid: int) -> float:
    """[MB]; 0 of a process that is gone."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * 4096 / 1e6
    except (OSError, IndexError):
        return 0.0


def watched(path: Path, seconds: float) -> dict[str, Memory]:
    """A run of `square` in real time with recorder and view, whose file is 80 MB a minute; memory of each process."""
    endpoint = free_endpoint()
    words = ("run", "square", "--duration", f"{seconds:g}", "--listen", endpoint, "--record", str(path))
    view = ("view", "--connect", endpoint, "--save", str(path.with_suffix(".rrd")), "--patience", "60")
    with started(*words, *FIFO, *LOOSE, *UNDRAWN, cwd=path.parent) as run, started(*view, cwd=path.parent) as viewer:
        pids = {role: child(run.pid, role, 60.0) for role in ROLES[:-1]} | {"view": viewer.pid}
        samples: dict[str, list[float]] = {role: [] for role in ROLES}
        while not path.exists() and run.poll() is None:
            time.sleep(0.05)
        begun = time.monotonic()
        while time.monotonic() < begun + 0.97 * seconds and run.poll() is None:
            for role, pid in pids.items():
                samples[role].append(resident(pid))
            time.sleep(seconds / 200)
        assert viewer.wait(60 + 0.1 * seconds) == 0, words_of(viewer)
        assert run.wait(60 + 0.2 * seconds) == 0, words_of(run)
        assert run.stdout is not None
        path.with_suffix(".json").write_text(run.stdout.read())
    return {role: _memory([each for each in found if each]) for role, found in samples.items()}


def _memory(found: list[float]) -> Memory:
    settled = round(SETTLED * len(found))
    return Memory(float(np.median(found[settled : settled + 10])), float(np.median(found[-10:])))


def assert_held(path: Path, seconds: float) -> None:
    memory = watched(path, seconds)
    summary = json.loads(path.with_suffix(".json").read_text())
    recording = read(path, ["timing", "measurement"])
    late = recording.columns("timing")["lateness"] / 1e6
    for low, high, count in zip(EDGES, EDGES[1:], np.histogram(late, EDGES)[0], strict=False):
        print(f"lateness {low:6.1f} .. {high:6.1f} ms: {count}")
    print({role: f"{found.settled:.1f} -> {found.end:.1f} MB" for role, found in memory.items()}, flush=True)
    print(f"lost: {summary['lost']}; late commands {summary['commands']['late']} of {summary['commands']['sent']}")
    assert summary["lost"] == {}
    assert len(recording.columns("measurement")["tick"]) == round(1000 * seconds) + 1
    assert path.with_suffix(".rrd").stat().st_size > 10_000
    if seconds > 60.0:
        assert [role for role, found in memory.items() if not found.flat] == []


@pytest.mark.timed
def test_seconds_in_real_time_with_recorder_and_view_lose_nothing(tmp_path: Path):
    pytest.importorskip("rerun")
    assert_held(tmp_path / "a.mcap", 4.0)


@pytest.mark.endurance
@pytest.mark.timeout(2 * 3600)
def test_an_hour_in_real_time_with_recorder_and_view_holds_its_memory(tmp_path: Path):
    pytest.importorskip("rerun")
    assert_held(tmp_path / "a.mcap", 3600.0)


class Period(NamedTuple):
    """One period of the sine."""

    energy: float  # [J], mean: lifted, moving, and in the oil of both chambers
    oil: float  # [m^3], mean of what is stored
    books: float  # greatest |stored - what came in and went out| since the beginning, of what was stored then
    rounding: float  # what the additions to the counter of the pump may lose by then, of what was stored


def periods(scenario: Scenario) -> Iterator[Period]:
    """Of a run in process, by a hundred looks a second."""
    plant, controller = sides(scenario)
    start, looks = plant.true_state(), []
    between = round(0.01 / scenario.loop.daq_period)
    for number, _ in enumerate(exchange(plant, controller, scenario.ticks, lean=True)):
        if number % between == 0:
            true = plant.true_state()
            books = abs(true.oil_stored - start.oil_stored - _crossed(true) + _crossed(start)) / start.oil_stored
            looks.append((_energy(scenario, true), true.oil_stored, books))
        if len(looks) == round(100 * PERIOD):
            energy, oil, books = np.array(looks).T
            true, steps = plant.true_state(), number * scenario.loop.daq_period / scenario.loop.step
            rounding = np.finfo(float).eps * true.oil_pumped / start.oil_stored * np.sqrt(steps)
            yield Period(energy.mean(), oil.mean(), books.max(), rounding)
            looks = []


def _crossed(true: Any) -> float:
    """Oil that has come in [m^3]."""
    return true.oil_pumped - true.oil_relieved - true.oil_returned


def _energy(scenario: Scenario, true: object) -> float:
    """m g x + m v^2/2 + sum of p^2 V/(2 B), the chambers' volumes from the rig's own numbers."""
    state, cylinder = vars(true), circuit_of(scenario).parts.cylinder
    assert isinstance(cylinder, Cylinder)
    x, v, mass = state["position"], state["velocity"], state["mass"]
    lower = cylinder.dead_lower + cylinder.area_lower * x
    upper = cylinder.dead_upper + cylinder.area_upper * (cylinder.stroke - x)
    oil = lower * state["p_lower"] ** 2 + upper * state["p_upper"] ** 2
    return mass * (9.81 * x + 0.5 * v * v) + 0.5 * oil / cylinder.bulk_modulus


def assert_no_drift(seconds: float, *further: str) -> None:
    """The books of the oil hold, and late periods are like early ones: noise moves a period by its own spread alone."""
    found = list(periods(load("sine", [f"duration={seconds:g}", "expect=[]", *further])))[1:]
    third = len(found) // 3
    for name in ("energy", "oil"):
        early, late = (np.array([getattr(one, name) for one in part]) for part in (found[:third], found[-third:]))
        spread = max(early.std(), late.std(), 1e-9 * abs(early.mean()))
        moved = late.mean() - early.mean()
        print(f"{name}: {early.mean():.9g} -> {late.mean():.9g}, spread of a period {spread:.2g}", flush=True)
        assert abs(moved) < 6.0 * spread / np.sqrt(third)
    print(f"books of the oil after {seconds:g} s: {found[-1].books:.2g} of what is stored", flush=True)
    assert found[-1].books < found[-1].rounding


def test_a_minute_of_simulated_time_drifts_in_neither_energy_nor_oil():
    assert_no_drift(64.0, SCANS)


@pytest.mark.endurance
@pytest.mark.timeout(4 * 3600)
def test_a_day_of_simulated_time_drifts_in_neither_energy_nor_oil():
    """At a third of an hour's work."""
    assert_no_drift(86400.0, SCANS)
