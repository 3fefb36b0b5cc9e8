"""Facts of the thesis on the twin, and the fit of the rig's assumed numbers: docs/calibration.md.

python -m bridge.studies.calibration                          the facts, before and after, as a table
python -m bridge.studies.calibration --fit 1800               fit for half an hour, from the rig as it stands
python -m bridge.studies.calibration --trade-off              what changes of one number bring
python -m bridge.studies.calibration --fit 600 --weight "restart: peak of p2=5"    and see what that costs
"""

import argparse
from collections.abc import Mapping
from typing import Any

import numpy as np

from bridge.scenario import load
from bridge.studies.calibration.choices import CHOICES, chosen, of_the_rig, overrides, scaled
from bridge.studies.calibration.facts import FACTS, Rig, evaluate
from bridge.studies.calibration.fit import evolve, refine
from bridge.studies.calibration.rest import AFTER, pressures_at_rest
from bridge.studies.calibration.trade_off import SHOWN, marked, trade_off

BEFORE = "assumed-rig"  # the scenario with the numbers before
HALF = 0.5  # of the time for the evolution


def main() -> None:
    """Read the options, print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fit", type=float, metavar="SECONDS", help="fit for so long before the tables")
    parser.add_argument("--seed", type=int, default=1, help="of the fit")
    parser.add_argument("--weight", action="append", default=[], metavar="FACT=W", help="of a fact in the fit; 0: none")
    parser.add_argument("--trade-off", action="store_true", help="print what changes of one number bring, and end")
    options = parser.parse_args()
    if options.trade_off:
        print_trade_off()
    else:
        print_tables(options)


def print_tables(options: argparse.Namespace) -> None:
    """The facts and p2 at rest, before, as the rig stands, and after a fit that is asked for."""
    rigs: dict[str, Rig] = {"before": rig_of(BEFORE), "as it stands": overrides(of_the_rig())}
    facts = {name: evaluate(rig) for name, rig in rigs.items()}  # a rig that has none is refused before a long fit
    if options.fit:
        values = fitted(options.fit, dict(map(weight, options.weight)), options.seed)
        rigs["fitted"] = overrides(values)
        facts["fitted"] = evaluate(rigs["fitted"])
        print_choices(values)
    print_facts(facts)
    for name, rig in rigs.items():
        print_rest(name, rig)


def weight(text: str) -> tuple[str, float]:
    """A fact and what it counts; ValueError for an unknown one."""
    name, _, value = text.rpartition("=")
    if name not in [fact.name for fact in FACTS]:
        raise ValueError(f"{name!r} is not a fact; known: {', '.join(fact.name for fact in FACTS)}")
    return name, float(value)


def fitted(seconds: float, weights: Mapping[str, float], seed: int) -> dict[str, float]:
    """The numbers found from those of the rig."""
    rig = of_the_rig()
    start = np.clip([scaled(choice, rig[choice.name]) for choice in CHOICES], 0.0, 1.0)
    first = evolve(start, HALF * seconds, weights, seed)
    last = refine(first.shares, (1.0 - HALF) * seconds, weights)
    print(f"{first.evaluations + last.evaluations} evaluations, cost {last.cost:.3g}")
    return chosen(last.shares)


def rig_of(scenario: str) -> dict[str, dict[str, Any]]:
    """All numbers of a scenario's rig, and where its piston waits."""
    loaded = load(scenario)
    return loaded.rig_values() | {"start": {"position": loaded.start.position}}


def print_choices(values: Mapping[str, float]) -> None:
    """Range, value before and after of each number."""
    rig = of_the_rig()
    print("\n| number, SI | range | without a fact | in the rig | fitted |\n|---|---|---|---|---|")
    for choice in CHOICES:
        low, high, prior = choice.low, choice.high, choice.prior
        print(f"| {choice.name} | {low:g} .. {high:g} | {prior:g} | {rig[choice.name]:g} | {values[choice.name]:.4g} |")


def print_facts(columns: Mapping[str, Mapping[str, float]]) -> None:
    """Each fact and what the twin makes of it; a miss is marked."""
    print(f"\n| fact | measured | {' | '.join(columns)} |\n|---|---|{'---|' * len(columns)}")
    for fact in FACTS:
        values = [found[fact.name] for found in columns.values()]
        marked = [f"{v:.4g}" if fact.low <= v <= fact.high else f"**{v:.4g}**" for v in values]
        print(f"| {fact.name}, {fact.unit} | {fact.low:g} .. {fact.high:g} | {' | '.join(marked)} |")


def print_trade_off() -> None:
    """Each change, what it brings, and the sum of the squares of all misses."""
    print(f"| change | {' | '.join(SHOWN)} | sum |\n|---|{'---|' * (len(SHOWN) + 1)}")
    for row in trade_off():
        cells = [marked(name, value) for name, value in row.found.items()]
        print(f"| {row.words} | {' | '.join(cells)} | {row.squares:.1f} |", flush=True)


def print_rest(name: str, rig: Rig) -> None:
    """p2 and p2 - p3 over the time at rest."""
    print(f"\n| {name}: p2 (p2 - p3), bar | {' | '.join(f'{after:g} s' for after in AFTER)} |")
    print(f"|---|{'---|' * len(AFTER)}")
    for speed, (lower, difference) in pressures_at_rest(rig).items():
        cells = [f"{p:.1f} ({d:.1f})" for p, d in zip(lower, difference, strict=True)]
        print(f"| {speed} rpm | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
