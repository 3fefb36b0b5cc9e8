"""Rigs in order for a day, an hour each; what once made hours fail is in tests/twin/test_estimation.py."""

from pathlib import Path

import pytest

from bridge.studies.sweep.journal import Journal
from tests.benchmarks.health_trial import AT, RULES, Trial, watched

HOUR = 3600  # [s]


@pytest.mark.endurance
@pytest.mark.timeout(3 * HOUR)
@pytest.mark.parametrize("seed", range(24))
def test_a_rig_in_order_is_followed_for_an_hour_and_not_called_ill(seed: int, tmp_path: Path):
    """Every other one 10 % off in five numbers. No alarm, no estimate begun anew, and nothing lost of it."""
    journal = Journal(tmp_path / "hour.part", {"title": "hour"})
    watched(seed, journal, {"in order": Trial("", HOUR - AT)})
    (found,) = Journal(tmp_path / "hour.part", {"title": "hour"}).found.values()
    assert found["alarm"] is None
    assert found["restarts"] == 0
    assert found["not_known"] <= RULES.look * (RULES.resting + RULES.window + 1)
