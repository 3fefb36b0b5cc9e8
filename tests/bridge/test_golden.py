"""The golden recordings still come out of the code, within stated tolerances."""

import numpy as np
import pytest

from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process
from tests.tools.renew import GOLDEN, HERE

# Another processor rounds differently; friction and the 12 bit card turn that into single counts.
TOLERANCES = {"position": 1e-4, "spool": 2e-3, "p1": 5e4, "p_lower": 5e4, "p_upper": 5e4, "oil_stored": 1e-8}


@pytest.mark.parametrize("name", sorted(GOLDEN))
def test_golden_recording_comes_out_again(name, tmp_path):
    golden = read(HERE / f"{name}.mcap")
    fresh = record_in_process(GOLDEN[name].load(), tmp_path / "fresh.mcap")
    kept, now = golden.columns("state"), fresh.columns("state")
    assert np.array_equal(kept["stamp"], now["stamp"])
    for signal, tolerance in TOLERANCES.items():
        worst = np.abs(kept[signal] - now[signal]).max()
        assert worst <= tolerance, f"{signal} moved by {worst:g}, allowed {tolerance:g}"


@pytest.mark.parametrize("name", sorted(GOLDEN))
def test_golden_recordings_are_small_and_carry_their_scenario(name):
    path = HERE / f"{name}.mcap"
    assert path.stat().st_size < 500_000
    assert read(path).scenario() == GOLDEN[name].load()
