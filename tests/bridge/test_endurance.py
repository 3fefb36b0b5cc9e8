"""Long trials; the short forms are in the other modules."""

import random
import signal
import time

import pytest

from bridge.recording.digest import digest
from bridge.recording.reader import read
from tests.support.processes import (
    LOOSE,
    children,
    run_recorded,
    started,
    summary,
    with_signal,
)

pytestmark = [pytest.mark.endurance, pytest.mark.timeout(1200)]


def test_ten_minutes_in_real_time_lose_nothing(tmp_path):
    path = tmp_path / "long.mcap"
    recording = run_recorded(path, "square", "--duration", "600", *LOOSE)
    assert len(recording.columns("measurement")["tick"]) == 600_001
    assert not summary(path)["lost"]


def test_a_minute_in_lockstep_is_a_minute_in_process(tmp_path):
    for name in ("step", "square", "sine"):
        paths = [tmp_path / f"{name}-{mode}.mcap" for mode in ("inprocess", "lockstep")]
        for path, mode in zip(paths, ("inprocess", "lockstep"), strict=True):
            run_recorded(path, name, "--duration", "60", "--mode", mode)
        assert digest(paths[0]) == digest(paths[1])


def test_ctrl_c_at_thirty_random_moments(tmp_path):
    rng = random.Random(7)
    for turn in range(30):
        path = tmp_path / f"{turn}.mcap"
        with started("run", "step", "--duration", "60", "--record", str(path)) as run:
            time.sleep(rng.uniform(0.1, 5.0))
            ours = set(children(run.pid))
            with_signal(run.pid, signal.SIGINT)
            output, _ = run.communicate(timeout=60)
        assert "Traceback" not in output
        assert not ours & set(children(1))
        if path.exists():
            read(path)
