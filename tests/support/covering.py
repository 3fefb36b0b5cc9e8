"""Random drives in which every pair of kinds meets: a pairwise covering sample, run by the interpreted step.

Compiling one combination takes seconds, so each drive runs a few hundred steps of the same source in Python.
Lines of model `ends` take Python seconds to fit; the built-in drives have them.
`python -m tests.support.covering SEED` prints the drives; with `--run STEPS` and NUMBA_DISABLE_JIT=1 it runs them.
"""

import argparse
import json
import math
import random
from collections.abc import Iterator
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from twin.accessory import INFLOW, LINE
from twin.circuit.build import build
from twin.circuit.ends import BACK_5, BACK_6, LOWER, RELIEF_END, TEE_1, TEE_2, UPPER, A, B, P, T
from twin.circuit.equilibrium import equilibrium
from twin.circuit.state import State, flatten, oil_in, unflatten
from twin.circuit.step import step_once
from twin.rig import values

Kinds = dict[str, str]
BAR = 1e5
LUMPED = {f"pipe_{n}": {"model": "lumped"} for n in range(1, 8)}
SLOTS: dict[str, dict[str, dict[str, dict[str, Any]]]] = {  # slot, kind: what the scenario says
    "supply": {
        "gear": {},
        "fixed": {"supply": {"kind": "fixed"}, "fixed_pump": {"leakage": 2e-11}},
        "variable": {"supply": {"kind": "variable"}, "variable_pump": {"cut_off": 90 * BAR}},
        "pressure": {"supply": {"kind": "pressure"}, "pressure_source": {"pressure": 100 * BAR}},
    },
    "accumulator": {
        "none": {},
        "at the tee": {"accumulator": {"kind": "bladder", "at": "tee", "volume": 5e-4, "precharge": 50 * BAR}},
        "at P": {"accumulator": {"kind": "bladder", "at": "p", "volume": 5e-4, "precharge": 50 * BAR}},
    },
    "relief": {
        "two-stage": {},
        "two-stage on its line": {"relief": {"place": "pipe_7"}},
        "direct": {"relief": {"kind": "direct"}, "direct_relief": {"cracking_pressure": 80 * BAR}},
        "direct on its line": {
            "relief": {"kind": "direct", "place": "pipe_7"},
            "direct_relief": {"cracking_pressure": 80 * BAR, "hysteresis": 3 * BAR},
        },
        "none": {"relief": {"kind": "none"}},
    },
    "check valve": {"none": {}, "fitted": {"check_valve": {"kind": "fitted"}}},
    "return end": {
        "open": {},
        "orifice": {"return_end": {"kind": "orifice", "diameter": 6e-3}},
        "check": {"return_end": {"kind": "check"}},
    },
    "valve": {
        "proportional": {},
        "switching": {"valve": {"kind": "switching"}},
        "servo": {"valve": {"kind": "servo"}, "servo_valve": {"hysteresis": 0.02, "threshold": 0.004}},
        "servo with underlap": {
            "valve": {"kind": "servo"},
            "servo_valve": {
                **{f"overlap_{land}": -0.02 for land in ("p_a", "b_t", "p_b", "a_t")},
                "ratio_p_b": 0.5,
                "ratio_b_t": 0.5,
                "dynamics": "first-order",
                "delay": 1e-3,
                "flow_force": 0.05,
            },
        },
    },
    "accessory at A": {
        "none": {},
        "counterbalance": {"accessory_a": {"kind": "counterbalance", "setting": 90 * BAR}},
        "pilot-check": {"accessory_a": {"kind": "pilot-check"}},
        "throttle": {"accessory_a": {"kind": "throttle"}},
        "throttle-check": {"accessory_a": {"kind": "throttle-check"}},
    },
    "accessory at B": {
        "none": {},
        "counterbalance": {"accessory_b": {"kind": "counterbalance", "setting": 90 * BAR, "dynamics": "lag"}},
        "pilot-check": {"accessory_b": {"kind": "pilot-check"}},
        "throttle": {"accessory_b": {"kind": "throttle"}},
        "throttle-check": {"accessory_b": {"kind": "throttle-check", "meters": "in"}},
    },
    "cushion": {"none": {}, "orifice": {"cushion": {"kind": "orifice"}}, "spear": {"cushion": {"kind": "spear"}}},
    "actuator": {
        "rod at A": {},
        "rod at B, level": {"cylinder": {"rod_at": "b", "angle": 0.0, "outside_lower": 1e14}},
        "two rods": {"cylinder": {"rod_at": "both", "angle": 0.3, "wall": 5e-3}},
        "motor": {"actuator": {"kind": "motor"}, "motor": {"ripple": 0.05, "radius": 0.05}},
    },
    "friction": {
        "seal": {},
        "stribeck": {"friction": {"kind": "stribeck"}},
        "lugre": {"friction": {"kind": "lugre", "negative": 0.8}},
        "none": {"friction": {"kind": "none"}},
    },
    "load": {
        "mass": {},
        "environment": {"load": {"kind": "environment", "stiffness": 2e4, "neutral": 0.1, "quadratic": 500.0}},
        "compliant": {"load": {"kind": "compliant", "far_mass": 80.0}},
        "lever": {"load": {"kind": "lever"}},
    },
    "lines": {
        "lumped": {**LUMPED},
        "nodes": {f"pipe_{n}": {"model": "nodes"} for n in range(1, 8)},
        "volume": {f"pipe_{n}": {"model": "volume"} for n in range(1, 8)},
        "none at the cylinder": {**LUMPED, **{f"pipe_{n}": {"model": "none"} for n in (3, 4)}},
        "creeping hoses": {**LUMPED, **{f"pipe_{n}": {"model": "lumped", "creep": 0.3} for n in (3, 4)}},
    },
    "oil": {
        "thesis": {},
        "numbers": {"oil": {"kind": "numbers"}},
        "iso-vg": {"oil": {"kind": "iso-vg", "grade": "68"}},
        "with air": {"oil": {"kind": "numbers", "air": 0.01}},
    },
}
SPREAD = (  # numbers that each drive draws at random: part, name, lowest and highest share of the default
    ("load", "mass", 0.7, 3.0),
    ("cylinder", "dead_lower", 0.5, 5.0),
    ("cylinder", "dead_upper", 0.5, 5.0),
    ("pipe_3", "length", 0.7, 2.0),
    ("pipe_4", "length", 0.7, 2.0),
    ("pipe_2", "diameter", 0.8, 1.5),
)
REFERENCES = (0.0, 1.0, -1.0, 0.3, -0.4)  # of the spool, one after the other


class Outcome(NamedTuple):
    """What is asked of one run."""

    kinds: Kinds
    lowest: float  # pressure above that of vapour [Pa]
    lost: float  # oil that the books do not know, of what passed or is stored
    created: float  # energy that parts without a store gave, of what was put through
    drift: float  # of the piston under the valve at rest [m]


def pairs(kinds: Kinds) -> set[tuple[tuple[str, str], tuple[str, str]]]:
    """All pairs of kinds in a drive."""
    return set(combinations(sorted(kinds.items()), 2))


def every_pair() -> set[tuple[tuple[str, str], tuple[str, str]]]:
    """All pairs that there are."""
    return {
        pair
        for one, other in combinations(sorted(SLOTS), 2)
        for pair in (((one, a), (other, b)) for a in SLOTS[one] for b in SLOTS[other])
    }


def covering(seed: int) -> list[Kinds]:
    """Drives that cover every pair: each starts from a pair that is missing and adds what covers most."""
    draw, missing, found = random.Random(seed), every_pair(), []
    while missing:
        drive = dict(draw.choice(sorted(missing)))
        for slot in draw.sample(sorted(SLOTS), len(SLOTS)):
            if slot not in drive:
                drive[slot] = max(
                    draw.sample(sorted(SLOTS[slot]), len(SLOTS[slot])),
                    key=lambda kind, slot=slot: len(pairs({**drive, slot: kind}) & missing),
                )
        found.append(drive)
        missing -= pairs(drive)
    return found


def numbers_of(kinds: Kinds, seed: int) -> dict[str, dict[str, Any]]:
    """The numbers of a drive, some of them random."""
    draw, own = random.Random(f"{seed} {sorted(kinds.items())}"), values()
    for slot, kind in kinds.items():
        for part, entries in SLOTS[slot][kind].items():
            own[part] |= entries
    for part, name, low, high in SPREAD:
        own[part][name] *= math.exp(draw.uniform(math.log(low), math.log(high)))
    return own


def outcome(kinds: Kinds, seed: int, steps: int, step: float) -> Outcome:
    """Run a drive from rest through all REFERENCES, a share of the steps each."""
    circuit = build(numbers_of(kinds, seed), step)
    circuit = circuit._replace(parts=_as_compiled(circuit.parts))
    start = equilibrium(circuit, 0.1)
    state, stored = copied(start), oil_in(start)
    lowest, made, turned, drift = math.inf, 0.0, 0.0, 0.0
    for reference in REFERENCES:
        for _ in range(steps // len(REFERENCES)):
            core = step_once(state.core, reference, circuit.parts, circuit.lines, state.ends, state.slots, state.memory)
            state = state._replace(core=core)
            lowest = min(lowest, float(state.ends.pressure.min()) - circuit.parts.oil.vapour_pressure)
            for power in _powers(state, kinds):
                made, turned = made + max(0.0, -float(power.sum())), turned + float(np.abs(power).sum())
        if reference == 0.0 and not drift:
            drift = abs(state.piston.position - start.piston.position)
    if not np.isfinite(flatten(state)).all():
        raise ArithmeticError(f"a number that is not finite: {kinds}")
    books = state.ledger.pumped - state.ledger.relieved - state.ledger.returned
    passed = state.ledger.pumped + abs(oil_in(state)) + circuit.parts.line_volume
    lost = abs(oil_in(state) - stored - books) / passed
    return Outcome(kinds, lowest, lost, made / max(turned, 1e-9), drift)


def _powers(state: State, kinds: Kinds) -> Iterator[np.ndarray]:
    """Power [W] at the ends of each part that has no store of its own: their sum is what it turns into heat."""
    at = -state.ends.pressure * state.ends.flow
    if kinds["accumulator"] != "at P":
        yield at[[P, A, B, T]]
    if kinds["accumulator"] != "at the tee":
        yield at[[TEE_1, TEE_2, RELIEF_END]]
    yield at[[BACK_5, BACK_6]]
    for end, memory in ((LOWER, state.slots.accessory_a), (UPPER, state.slots.accessory_b)):
        yield memory[INFLOW] * np.array([memory[LINE], -state.ends.pressure[end]])


def _as_compiled(parts: Any) -> Any:
    """The same numbers, which divided by zero give infinity as in compiled code."""
    if isinstance(parts, tuple):
        made = map(_as_compiled, parts)
        return type(parts)(*made) if hasattr(parts, "_fields") else tuple(made)
    return np.float64(parts) if isinstance(parts, float) else parts


def copied(state: State) -> State:
    """A state of its own arrays."""
    return unflatten(flatten(state))


def main() -> None:
    """Print one line of JSON for each drive of a share of the sample, or the sample itself."""
    asked = argparse.ArgumentParser(description="Random drives in which every pair of kinds meets.")
    asked.add_argument("seed", type=int)
    asked.add_argument("--run", type=int, default=0, help="Steps of each drive; 0 prints the sample")
    asked.add_argument("--step", type=float, default=50e-6, help="[s]")
    asked.add_argument("--share", default="0/1", help="Which of how many shares: 1/2 is the second half")
    options = asked.parse_args()
    sample, (which, of) = covering(options.seed), map(int, options.share.split("/"))
    if not options.run:
        for kinds in sample:
            print("; ".join(f"{slot}: {kind}" for slot, kind in kinds.items()))
        print(f"{len(sample)} drives cover {len(every_pair())} pairs")
        return
    for kinds in sample[which::of]:
        print(json.dumps(outcome(kinds, options.seed, options.run, options.step)._asdict()), flush=True)


if __name__ == "__main__":
    with np.errstate(all="ignore"):
        main()
