"""The cases of the table: laws, masses, sampling periods, delays and steps."""

import itertools
import random
from collections.abc import Sequence
from typing import NamedTuple

from bridge.scenario import Scenario, load
from bridge.studies.stability.sampled_law import free_gain

PERIODS = (1, 2, 5, 10, 20, 50, 100)  # [ms]
DELAYS = (0.0, 0.5, 1.0, 2.0, 4.0)  # [sampling periods]
MASSES = (120, 303)  # [kg]
STEPS = (2, -2, 20, -20, 60, -60)  # [mm]
LAWS: dict[str, tuple[str, ...]] = {
    "pd": (),
    "pd tachometer": ("controller.derivative=0.005",),
    "pd difference": ("controller.derivative=0.02", "controller.velocity=backward"),
    "pd filtered": ("controller.derivative=0.02", "controller.velocity=filtered"),
    "pid": ("controller.kind=pid", "controller.integral=0.05"),
    "linear": ("controller.kind=state-space",),
    "python": ("controller.law=examples/my_law.py:law",),
    "dead band": ("controller.compensate_overlap=false",),
}
ORDER = 13  # of the random sample


class Case(NamedTuple):
    """One row to fill."""

    law: str
    mass: float  # [kg]
    period: float  # [ms]
    delay: float  # [sampling periods]
    size: float  # [mm]


def cases(laws: Sequence[str], order: int = ORDER) -> list[Case]:
    """All of the table, in a fixed random order."""
    found = [Case(*numbers) for numbers in itertools.product(laws, MASSES, PERIODS, DELAYS, STEPS)]
    random.Random(order).shuffle(found)
    return found


def first_of_each(laws: Sequence[str], most: int, order: int = ORDER) -> list[Case]:
    """So many cases of each law, half of them of each mass."""
    count: dict[tuple[str, float], int] = {}
    found = []
    for case in cases(laws, order):
        kind = (case.law, case.mass)
        count[kind] = count.get(kind, 0) + 1
        if 2 * count[kind] <= most:
            found.append(case)
    return found


def scenario_of(case: Case) -> Scenario:
    """The loop of a case."""
    delay = round(case.delay * case.period * 1e-3 / 50e-6) * 50e-6
    times = [f"loop.sample_period={case.period * 1e-3!r}", f"loop.delay={delay!r}"]
    timeout = f"loop.command_timeout={max(0.1, case.period * 1e-2)!r}"
    law = [*LAWS[case.law], *(_lag(case) if case.law == "linear" else [])]
    return load("step", [*times, timeout, f"rig.load.mass={case.mass}", *law])


def _lag(case: Case) -> list[str]:
    """Matrices of half the scenario's gain at once, and half with a lag of a few samples."""
    half = 0.5 * free_gain(load("step")).own
    rows = f"controller.A=[[0.8]];controller.B=[[1.0]];controller.C=[[{0.2 * half!r}]];controller.D=[[{half!r}]]"
    return [f"controller.dt={case.period * 1e-3!r}", *rows.split(";")]
