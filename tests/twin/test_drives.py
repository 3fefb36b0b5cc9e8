"""Drives of all kinds: whatever is fitted together keeps its oil, makes no energy and stays above the vapour pressure.

`python -m tests.support.covering 1` prints the drives of the suite; `make endurance` runs those of other seeds, longer.
"""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import pytest

from tests.support.covering import covering, every_pair, pairs

SHARES = 2


def outcomes(seed: int, steps: int, share: str = "0/1", step: str = "50e-6") -> Iterator[dict[str, Any]]:
    """What became of the drives of a share, run by the interpreted step in a process of its own."""
    arguments = [str(seed), "--run", str(steps), "--share", share, "--step", step]
    command = [sys.executable, "-m", "tests.support.covering", *arguments]
    interpreted = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(command, capture_output=True, text=True, timeout=1500, env=interpreted)
    assert done.returncode == 0, done.stderr[-2000:]
    return map(json.loads, done.stdout.splitlines())


def hold(found: dict[str, Any]) -> None:
    """The claims about one drive; pressures to a thousandth of a pascal, oil and energy to rounding."""
    kinds = found["kinds"]
    assert found["lowest"] >= -1e-3, kinds
    assert found["lost"] <= 1e-12, kinds
    assert found["created"] <= 1e-6, kinds


def test_the_sample_covers_every_pair_of_kinds():
    assert set().union(*map(pairs, covering(1))) == every_pair()


@pytest.mark.parametrize("share", range(SHARES))
def test_random_drives_keep_oil_and_energy(share: int):
    for found in outcomes(1, 120, f"{share}/{SHARES}", "100e-6" if share else "50e-6"):
        hold(found)


@pytest.mark.endurance
@pytest.mark.timeout(1600)
@pytest.mark.parametrize("seed", range(2, 8))
def test_further_random_drives_keep_oil_and_energy(seed: int):
    for found in outcomes(seed, 2000):
        print("; ".join(f"{slot}: {kind}" for slot, kind in found["kinds"].items()))
        hold(found)
