"""The trial of the follower: rigs that differ from what the twins know, drawn as the twins assume; errors and coverage.

    python -m tests.benchmarks.following trial.csv                  until interrupted; the next call goes on
    python -m tests.benchmarks.following trial.csv --seconds 500    stop after so long
    python -m tests.benchmarks.following trial.csv --part 0/2       every other seed, for two processes
    python -m tests.benchmarks.following trial.csv --shares         print what is there

A rig's load, friction, valve, pump and relief setting differ by some 10 % (the setting by 3 %); its sensors have their
noise, its commands a delay of 5 ms. p3 is not used. Each row is one seed: of each quantity the rms error, the mean
stated deviation, and the shares of instants within 1 and 1.96 of them. Two processes may append to the same file.
"""

import argparse
import csv
import math
import time
from pathlib import Path

import numpy as np

from bridge.loop.follower import FollowerSide
from bridge.replay.into_follower import through_follower
from bridge.runs.in_process import run_in_memory
from bridge.scenario import load
from bridge.wire.messages import ESTIMATE
from twin.estimation.settings import Settings

QUANTITIES = ("p_upper", "friction", "load", "velocity", "p_p")
DURATION, FROM = 4.0, 1.0  # [s]
COMMON = [f"duration={DURATION}", "loop.delay=5 ms"]
GRAVITY = 9.81
FIELDS = ("seed", *(f"{name}_{what}" for name in QUANTITIES for what in ("rms", "sd", "within_1", "within_2")))
Row = dict[str, float]


def rig(seed: int) -> list[str]:
    """Changes of the scenario that make the rig of a seed."""
    mass, friction, valve, pump, relief = np.random.default_rng(seed).standard_normal(5).tolist()
    rub, share = math.exp(0.1 * friction), math.exp(0.1 * pump)
    return [
        f"seed={seed}",
        f"rig.load.mass={max(60.0, 120.0 * (1.0 + 0.1 * mass))!r}",
        f"rig.seal.alpha={3.819e-6 * rub!r}",
        f"rig.seal.limit={0.25 * rub!r}",
        f"rig.valve.rated_flow={0.5e-3 * math.exp(0.1 * valve)!r}",
        f"rig.pump.width={63e-3 * share!r}",
        f"rig.relief.setting={67e5 * math.exp(0.03 * relief)!r}",
    ]


def trial(seed: int, settings: Settings, scenario: str = "sine", duration: float = DURATION) -> Row:
    """One rig, followed."""
    common = [*COMMON, f"duration={duration}"]
    rec = run_in_memory(load(scenario, [*common, *rig(seed)]))
    side, state = FollowerSide(load(scenario, common), settings), rec.columns("state")
    found = [m.message for out in through_follower(rec, side) for m in out if m.topic == ESTIMATE]
    found = [message for message in found if message.stamp >= FROM * 1e9]
    at = np.searchsorted(state["stamp"], [message.stamp for message in found])
    truth = {name: state[name][at] for name in QUANTITIES if name != "load"} | {"load": -GRAVITY * state["mass"][at]}
    row: Row = {"seed": seed}
    for name in QUANTITIES:
        away = np.array([getattr(message, name) for message in found]) - truth[name]
        deviation = np.array([getattr(message, f"{name}_sd") for message in found])
        row |= {f"{name}_rms": float(np.sqrt((away**2).mean())), f"{name}_sd": float(deviation.mean())}
        for word, width in (("within_1", 1.0), ("within_2", 1.96)):
            row[f"{name}_{word}"] = float((np.abs(away) <= width * deviation).mean())
    return row


def rows_in(path: Path) -> list[Row]:
    """What is there."""
    if not path.is_file():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]


def add(path: Path, row: Row) -> None:
    """Append a row."""
    begin = not path.is_file()
    with path.open("a", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, FIELDS)
        if begin:
            writer.writeheader()
        writer.writerow(row)


def shares(rows: list[Row]) -> str:
    """A table of all rows."""
    lines = [f"{len(rows)} rigs", f"{'':10} {'rms error':>12} {'stated':>12} {'68.3 %':>8} {'95 %':>8}"]
    for name in QUANTITIES:
        rms = math.sqrt(np.mean([row[f"{name}_rms"] ** 2 for row in rows]))
        stated, one, two = (np.mean([row[f"{name}_{what}"] for row in rows]) for what in ("sd", "within_1", "within_2"))
        lines.append(f"{name:10} {rms:12.4g} {stated:12.4g} {100.0 * one:7.1f}% {100.0 * two:7.1f}%")
    return "\n".join(lines)


def main() -> None:
    """Run what is missing, or print what is there."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("path", type=Path)
    parser.add_argument("--seconds", type=float, default=math.inf)
    parser.add_argument("--seeds", type=int, default=300)
    parser.add_argument("--part", default="0/1")
    parser.add_argument("--shares", action="store_true")
    asked = parser.parse_args()
    part, parts = map(int, asked.part.split("/"))
    deadline = time.monotonic() + asked.seconds
    for seed in range(1, asked.seeds + 1):
        if asked.shares or time.monotonic() > deadline:
            break
        if seed % parts == part and seed not in {row["seed"] for row in rows_in(asked.path)}:
            add(asked.path, trial(seed, Settings(without=("p3",))))
    print(shares(rows_in(asked.path)))


if __name__ == "__main__":
    main()
