"""How soon faults are found and rightly named, and how often a rig in order is called ill.

    python -m tests.benchmarks.health_trial trial.part                  run what is missing, then print shares
    python -m tests.benchmarks.health_trial trial.part --rounds 3       the first rounds only
    python -m tests.benchmarks.health_trial trial.part --part 0/2       every other round, for two processes
    python -m tests.benchmarks.health_trial trial.part --in-order 3600  rigs in order alone, each for an hour
    python -m tests.benchmarks.health_trial trial.part --shares         print what is there

A round is one rig, in motion with a sine or random steps, with noise of its own. Its estimate comes to rest for 10 s,
then it is watched for 30 s. At 43 s the process forks, once for each fault, so that commissioning is paid for once.
Rigs of odd rounds are 10 % off in five numbers from the beginning, which the twins do not know. Each run is kept as it
ends; the next call goes on.
"""

import argparse
import json
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bridge.loop.exchange import exchange, sides
from bridge.loop.follower import FollowerSide
from bridge.loop.health import watching
from bridge.loop.plant import PlantSide
from bridge.runs.campaign.statistics import wilson
from bridge.scenario import Scenario, check, load
from bridge.studies.sweep.journal import Journal, key_of
from tests.support.beside import hand
from twin.cache_folder import fingerprint
from twin.estimation.health import Health, Rules
from twin.estimation.hypotheses import Verdict
from twin.estimation.settings import Settings

AT = 43  # [s], when the fault comes
ROUNDS = 20
RULES = Rules()
OFF = ("load.mass", "valve.rated_flow", "seal.limit", "seal.alpha", "cylinder.leakage_resistance")


class Trial(NamedTuple):
    """What is done to a rig, and what should be said of it."""

    right: str  # of HYPOTHESES; empty: in order
    wait: int  # [s]
    fault: Mapping[str, Any] = {}  # a table of docs/faults.md
    times: Mapping[str, float] = {}  # factors on numbers of the rig


IN_ORDER = "in order"
TRIALS = {
    IN_ORDER: Trial("", 30),
    "leak x3": Trial("leak_across", 30, {"target": "cylinder", "kind": "leak", "factor": 3.0}),
    "leak x10": Trial("leak_across", 12, {"target": "cylinder", "kind": "leak", "factor": 10.0}),
    "leak x30": Trial("leak_across", 12, {"target": "cylinder", "kind": "leak", "factor": 30.0}),
    "friction +60 %": Trial("friction", 12, times={"seal.limit": 1.6, "seal.alpha": 1.6}),
    "bulk modulus -30 %": Trial("air_in_oil", 12, {"target": "oil", "kind": "air", "factor": 0.7}),
    "valve gain -8 %": Trial("valve_gain", 12, times={"valve.rated_flow": 0.92}),
    "load +30 %": Trial("load", 12, times={"load.mass": 1.3}),
    "valve offset 2 %": Trial("valve_offset", 12, {"target": "valve", "kind": "bias", "size": 0.02}),
    "filter x30": Trial("filter_blocked", 12, {"target": "filter", "kind": "blocked", "factor": 30.0}),
    "leak of the lower chamber": Trial(
        "leak_outside_lower", 14, {"target": "pipe_3", "kind": "burst", "diameter": 0.3e-3}
    ),
    "leak of the upper chamber": Trial(
        "leak_outside_upper", 14, {"target": "pipe_4", "kind": "burst", "diameter": 0.3e-3}
    ),
    "pump leak x2": Trial("pump_wear", 12, {"target": "pump", "kind": "wear", "factor": 2.0}),
    "p2 drifts, 1 bar/min": Trial("sensor_p2", 60, {"target": "sensor.p2", "kind": "drift", "rate": 1e5 / 60.0}),
}


def begin(trial: Trial, plant: PlantSide, scenario: Scenario) -> None:
    """Let it happen now."""
    data = scenario.model_dump(mode="json")
    if trial.fault:
        whole = check(data | {"fault": [{**trial.fault, "at": 0.0}]}, "trial")
        plant.inject(whole.fault[0].model_copy(update={"at": None}))
    if trial.times:
        plant.set({f"rig.{name}": factor * _number(data["rig"], name) for name, factor in trial.times.items()})


def _number(rig: Mapping[str, Any], name: str) -> float:
    part, number = name.split(".")
    return float(rig[part][number])


def motion(seed: int, duration: int) -> dict[str, Any]:
    """A sine of 2 s, or steps of up to 50 mm each second."""
    if seed % 4 < 2:
        return {"kind": "sine", "mean": 0.13, "amplitude": 0.025, "frequency": 0.5, "at": 0.5}
    drawn = np.random.default_rng(seed).uniform(0.105, 0.155, duration)
    lines = [f"{k + edge},{x:.4f}" for k, x in enumerate(drawn) for edge in (0.0, 0.99)]
    return {"kind": "table", "csv": "time_s,position_m\n" + "\n".join(lines) + "\n"}


def rigs(seed: int, longest: int) -> tuple[Scenario, Scenario]:
    """What runs for so long [s], and what the twins know of it."""
    base = load("sine").model_dump(mode="json")
    base["rig"]["cylinder"]["holes"] = "fitted"  # what a burst tears open
    base |= {"duration": float(longest), "seed": seed, "reference": motion(seed, longest)}
    known = check(base, "known")
    if seed % 2:
        signs = np.random.default_rng(seed).choice([0.9, 1.1], len(OFF))
        for name, factor in zip(OFF, signs, strict=True):
            part, number = name.split(".")
            base["rig"][part][number] *= float(factor)
    return check(base, "true"), known


def watched(seed: int, journal: Journal, trials: Mapping[str, Trial]) -> None:
    """A round: every run of it that is missing."""
    missing = [name for name in trials if key_of(point(seed, name)) not in journal.found]
    if not missing:
        return
    truth, known = rigs(seed, AT + max(trial.wait for trial in trials.values()))
    side = FollowerSide(known, watching(Settings()), seed=1 + seed, rules=RULES)
    assert side.health is not None
    plant, controller = sides(truth)
    looks: list[Health] = []
    mine, end = "", AT * 1000
    for tick, messages in enumerate(exchange(plant, controller, truth.ticks)):
        hand(messages, side)
        if side.health.latest is not (looks[-1] if looks else None):
            looks.append(side.health.latest)
        if tick == end and mine:
            journal.add(point(seed, mine), outcome(looks) | {"restarts": side.restarts})
            os._exit(0)
        if tick == end:
            mine = forked(missing)
            if not mine:
                return
            begin(trials[mine], plant, truth)
            end += trials[mine].wait * 1000


def forked(names: Sequence[str]) -> str:
    """In a child its name, one child after the other; in the parent, at the end, nothing."""
    for name in names:
        child = os.fork()
        if not child:
            return name
        os.waitpid(child, 0)
    return ""


def point(seed: int, name: str) -> dict[str, Any]:
    """A run by its name."""
    return {"round": seed, "trial": name}


def outcome(looks: Sequence[Health]) -> dict[str, Any]:
    """When there was an alarm, which name came first and when, and which was the last."""
    ill = [health for health in looks if health.verdict > Verdict.HEALTHY]
    named = [health for health in looks if health.verdict is Verdict.FAULT]
    judged = sum(health.verdict >= Verdict.HEALTHY for health in looks)
    lost = sum(health.verdict is Verdict.NOT_KNOWN for health in looks)
    first, last = (named[0], named[-1]) if named else (None, None)
    return {
        "judged": judged * RULES.look,
        "not_known": lost * RULES.look,
        "alarm": ill[0].stamp if ill else None,
        "name": first.suspects[0] if first else None,
        "named": first.stamp if first else None,
        "last": last.suspects[0] if last else None,
        "size": last.findings[last.suspects[0]].size if last else None,
        "explained": bool(last and last.explained),
        "at_end": looks[-1].verdict.name.lower(),
        "farthest": max((abs(f.deviate) for h in looks for f in h.findings.values()), default=0.0),
    }


def shares(journal: Journal) -> None:
    """Print them, for each fault, with Wilson's intervals of 95 %."""
    rows = [(json.loads(point), result) for point, result in journal.found.items()]
    print(f"{'fault':22}runs  found  {'named right first':>27}  {'wrong name first':>27}  median until alarm, name")
    for name, (right, *_) in TRIALS.items():
        of = [result for point, result in rows if point["trial"] == name]
        if not of or not right:
            continue
        hit = [r for r in of if r["name"] == right]
        wrong = [r for r in of if r["name"] not in (right, None)]
        alarms = [r["alarm"] - AT for r in of if r["alarm"]]
        waits = [r["named"] - AT for r in hit]
        told = ", ".join(f"{np.median(values):.1f} s" if values else "-" for values in (alarms, waits))
        both = f"{share(len(hit), len(of)):>27}  {share(len(wrong), len(of)):>27}"
        print(f"{name:22}{len(of):4}  {len(alarms):5}  {both}  {told}")
    in_order = [result for point, result in rows if point["trial"].startswith(IN_ORDER)]
    alarms = sum(result["alarm"] is not None for result in in_order)
    hours = sum(result["judged"] for result in in_order) / 3600.0
    most = 0.5 * _chi_squared(2 * alarms + 2) / hours if hours else math.inf  # Poisson, exact
    restarts = sum(result.get("restarts", 0) for result in in_order)
    unknown = sum(result.get("not_known", 0.0) for result in in_order)
    farthest = max((result["farthest"] for result in in_order), default=0.0)
    print(
        f"{len(rows)} runs; rigs in order for {hours:.4f} h: {alarms} false alarms, at most {most:.3g} per hour (95 %)"
    )
    print(f"greatest deviate of a rig in order {farthest:.2f}")
    print(f"estimates begun anew {restarts}, not known for {unknown:g} s")


def _chi_squared(freedom: int) -> float:
    from scipy.stats import chi2

    return float(chi2.ppf(0.95, freedom))


def share(count: int, runs: int) -> str:
    """With its interval."""
    found = wilson(count, runs)
    return f"{count}/{runs} ({100 * found.low:.0f} to {100 * found.high:.0f} %)"


def main() -> None:
    """Run what is missing and print what it says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part_file", type=Path)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--part", default="0/1")
    parser.add_argument("--in-order", type=int, metavar="SECONDS")
    parser.add_argument("--shares", action="store_true")
    asked = parser.parse_args()
    part, parts = map(int, asked.part.split("/"))
    trials = {f"{IN_ORDER}, {asked.in_order} s": Trial("", asked.in_order)} if asked.in_order else TRIALS
    told = {"title": "health", "twin": fingerprint(), "rules": repr(RULES)}
    if not asked.shares:
        for seed in range(part, asked.rounds, parts):
            watched(seed, Journal(asked.part_file, told), trials)
    shares(Journal(asked.part_file, told))


if __name__ == "__main__":
    main()
