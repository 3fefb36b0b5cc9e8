"""Fuzz of everything that comes from outside: seconds here, ten minutes each in `make endurance`."""

import gc
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, seed, settings

from tests.support.fuzzing import TARGETS, VALUES, decodes

MINUTES = 10.0
ROUND = 300  # examples, after which the memory is looked at and another seed taken
GROWTH = 60_000  # kB, over what a target has after its first quarter
QUIET = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much, HealthCheck.large_base_example]


def fuzz(strategy: Any, target: Callable[[Any], None], examples: int, number: int) -> None:
    """Some examples of a seed."""

    @seed(number)
    @settings(max_examples=examples, deadline=None, derandomize=False, suppress_health_check=QUIET)
    @given(strategy)
    def run(example: Any) -> None:
        target(example)

    run()


@pytest.mark.parametrize("name", TARGETS)
def test_whatever_comes_is_taken_or_refused(name):
    fuzz(*TARGETS[name], examples=25 if name in ("scenarios", "recordings") else 100, number=1)


@pytest.mark.endurance
@pytest.mark.timeout(MINUTES * 60 + 600)
@pytest.mark.parametrize("name", TARGETS)
def test_ten_minutes_of_whatever_comes(name):
    began, number, after_a_quarter = time.monotonic(), 1, 0
    while (passed := (time.monotonic() - began) / (MINUTES * 60)) < 1.0:
        number += 1
        fuzz(*TARGETS[name], examples=ROUND, number=number)
        gc.collect()
        if not after_a_quarter and passed > 0.25:
            after_a_quarter = resident()
    print(f"{name}: {(number - 1) * ROUND} examples, memory {after_a_quarter / 1e3:.0f} to {resident() / 1e3:.0f} MB")
    assert resident() - after_a_quarter < GROWTH


def resident() -> int:
    """Memory of this process now [kB]."""
    text = Path("/proc/self/status").read_text()
    return int(next(line.split()[1] for line in text.splitlines() if line.startswith("VmRSS")))


def test_fuzz_finds_what_is_not_caught():
    """A decoder that lets one kind of error out is found."""

    def careless(value: Any) -> None:
        if isinstance(value, dict) and not value:
            raise KeyError

    with pytest.raises(KeyError):
        fuzz(VALUES, careless, examples=300, number=1)
    decodes(("measurement", b""))
