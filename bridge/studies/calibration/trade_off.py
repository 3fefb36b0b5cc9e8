"""What no choice meets together: the rig as it stands with one number changed, nothing fitted again."""

from collections.abc import Iterator
from typing import NamedTuple

from bridge.studies.calibration.choices import of_the_rig, overrides
from bridge.studies.calibration.facts import FACTS, evaluate, misses

SHOWN = (
    "speed before the stop",
    "restart: peak of p2",
    "impingement: greatest p3",
    "impingement: greatest p2",
)
CHANGES = {
    "none": {},
    "pump weaker, `efficiency_pressure` 36 bar": {"pump.efficiency_pressure": 36e5},
    "pump stronger, 44 bar": {"pump.efficiency_pressure": 44e5},
    "line 1 as the fit left it, 1.25 m": {"pipe_1.length": 1.25},
    "line 3 short, 1.2 m": {"pipe_3.length": 1.2},
    "line 3 long, 3 m": {"pipe_3.length": 3.0},
    "hoses stiff, wall 5 mm": {"pipe_3.wall": 5e-3},
    "switching valve fast, 30 ms": {"switching_valve.switching_time": 30e-3},
    "switching valve slow, 80 ms": {"switching_valve.switching_time": 80e-3},
}


class Row(NamedTuple):
    """A change and what it brings."""

    words: str
    found: dict[str, float]  # of SHOWN, in the units of the facts
    squares: float  # sum of the squares of all misses, each in its scale


def trade_off() -> Iterator[Row]:
    """One row per change, some seconds each."""
    rig = of_the_rig()
    for words, change in CHANGES.items():
        found = evaluate(overrides(rig | change))
        yield Row(words, {name: found[name] for name in SHOWN}, float((misses(found) ** 2).sum()))


def marked(name: str, value: float) -> str:
    """A value with its unit; bold where the fact is missed."""
    fact = next(fact for fact in FACTS if fact.name == name)
    words = f"{value:.3g} {fact.unit}"
    return words if fact.low <= value <= fact.high else f"**{words}**"
