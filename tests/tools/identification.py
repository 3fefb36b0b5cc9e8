"""Does a fit know what it does not know? Worn rigs drawn at random, recorded by the card, fitted, compared with truth.

python -m tests.tools.identification --draws 100 --part draws.part      resumable; Ctrl-C loses one draw
python -m tests.tools.identification --so-far draws.part other.part     what has been found until now

Of each draw: numbers of the rig drawn from what is known before (log-normal), a recording of the closed loop as the
card has it (noise, rounding, skew, clipping), a fit that starts at the scenario's own numbers, and the Cramer-Rao bound
at the true ones. What must come out: nine or more in ten of the identified numbers lie within their stated 95 %
interval, and two numbers of which the data see only one combination are named.
"""

import argparse
import json
import math
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from bridge.runs.in_process import run_in_memory
from bridge.scenario import changed
from bridge.scenario.circuit import in_memory
from bridge.scenario.files import plain
from bridge.studies.identification.fit import fit, rms
from bridge.studies.identification.parameters import Parameter, parameters_of
from bridge.studies.identification.recorded import record_in
from bridge.studies.identification.residuals import Residuals, Task
from bridge.studies.identification.uncertainty import uncertainty
from bridge.studies.sweep.engine import HERE, Crew, rounds
from bridge.studies.sweep.journal import Point, Result

SCENARIO = Path(__file__).parents[1] / "support" / "scenarios" / "worn.toml"
WORN = {  # what is fitted, and how much of it is known before: deviation of the logarithm
    "rig.load.mass": 0.2,
    "rig.cylinder.leakage_resistance": 1.0,
    "rig.friction.coulomb": 0.1,
    "rig.friction.viscous": 0.3,
    "rig.oil.bulk_modulus": 0.1,
    "rig.servo_valve.natural_frequency": 0.1,
    "rig.servo_valve.rated_flow": 0.1,
    "rig.servo_valve.rated_drop": 0.1,
}
TOGETHER = {"rig.servo_valve.rated_flow", "rig.servo_valve.rated_drop"}  # only the area they make is in the twin
CHUNK = 4  # draws that are asked for at once


def excitation(seed: int, duration: float) -> str:
    """Random places between 50 and 220 mm, held for random times; as a table of a reference."""
    rng, t, rows, place = np.random.default_rng([seed, 1]), 0.6, [(0.0, 0.12), (0.6, 0.12)], 0.12
    while t < duration - 1.2:
        place = float(np.clip(place + rng.choice([-1.0, 1.0]) * rng.uniform(0.005, 0.11), 0.05, 0.22))
        rows.append((t + 1e-3, place))
        t += float(rng.uniform(0.15, 0.9))
        rows.append((t, place))
    return "\n".join(f"{at:.3f},{where:.5f}" for at, where in rows)


def draw(point: Point, duration: float = 30.5) -> dict[str, Any]:
    """One worn rig."""
    seed, duration, began = int(point["draw"]), float(point.get("seconds", duration)), time.process_time()
    base = plain(str(SCENARIO))
    base["reference"]["csv"] = excitation(seed, duration)
    own = changed(base, [f"seed={seed}", f"duration={duration} s"], "worn")
    names = parameters_of([",".join(WORN)], own, WORN)
    true = truth(names, seed)
    with in_memory():
        worn = changed(own.model_dump(mode="json"), [f"{n}={v!r}" for n, v in true.items()], "worn")
        record = record_in(run_in_memory(worn))
        recorded = time.process_time()
        found = fit((own.rig_values(), own.loop.step), [record], names)
    fitted = time.process_time()
    known = uncertainty(found)
    places = np.array([one.place(true[one.name]) for one in names])
    bound = cramer_rao(found.task, places, found.steps)
    return {
        "estimates": {e.parameter.name: _compared(e, true, b) for e, b in zip(known.estimates, bound, strict=True)},
        "named": TOGETHER in [{name for name, _ in one.shares} for one in known.untold],
        "length": found.length, "rms": rms(found), "robust": known.robust, "converged": found.converged,
        "white": [[one.signal, one.deviations, one.correlation] for one in known.whiteness],
        "seconds": {"record": recorded - began, "fit": fitted - recorded, "all": time.process_time() - began},
        "runs": found.runs,
    }  # fmt: skip


def truth(names: Sequence[Parameter], seed: int) -> dict[str, float]:
    """Numbers of a worn rig, drawn from what is known before."""
    rng = np.random.default_rng([seed, 0])
    drawn = {one.name: one.value(one.prior * rng.standard_normal()) for one in names}
    return {one.name: min(max(drawn[one.name], one.low), one.high * 0.999) for one in names}


def cramer_rao(task: Task, places: Any, steps: Any) -> list[float]:
    """Least deviation of the places of any unbiased fit that has what is known before, the starts of shots unknown.

    steps: for slopes, as the fit has found them.
    """
    residuals = Residuals(task, steps=steps)
    residuals.afresh(places)  # where the data alone lead it, the rod may stick where it slid
    jacobian = residuals.slopes(places)
    return np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian))).tolist()


def _compared(estimate: Any, true: dict[str, float], bound: float) -> dict[str, Any]:
    value, (low, high) = true[estimate.parameter.name], estimate.interval
    return {
        "true": value, "value": estimate.value, "identified": estimate.identified, "inside": low <= value <= high,
        "spread": estimate.spread, "bound": bound,
        "off": (estimate.place - estimate.parameter.place(value)) / estimate.spread,
    }  # fmt: skip


def found_in(paths: Iterable[Path]) -> list[Result]:
    """Results of parts so far."""
    lines = [line for path in paths for line in path.read_text().splitlines()[1:]]
    return [json.loads(line)["result"] for line in lines]


def report(results: Sequence[Result]) -> None:
    """What the draws say, in a table."""
    if not results:
        print("no draw is done yet")
        return
    seconds = sum(result["seconds"]["all"] for result in results)
    print(f"{len(results)} draws, {3600.0 * len(results) / seconds:.0f} per core-hour")
    every: list[bool] = []
    for name in WORN:
        told = [r["estimates"][name] for r in results if r["estimates"][name]["identified"]]
        every += [e["inside"] for e in told]
        wide = np.median([e["spread"] / e["bound"] for e in told]) if told else math.nan
        spread = np.median([e["spread"] for e in told]) if told else math.nan
        print(
            f"{name:34} identified {len(told):3}, inside {within([e['inside'] for e in told])}, median error "
            f"{spread:.2e}, {wide:.2f} x Cramer-Rao"
        )
    print(f"all identified: inside {within(every)}")
    print(f"the pair named in {within([r['named'] for r in results])}")
    print(f"whole record followed in {sum(r['length'] == math.inf for r in results)}, median CPU of a fit "
          f"{np.median([r['seconds']['fit'] for r in results]):.0f} s")  # fmt: skip


def within(inside: Sequence[bool]) -> str:
    """A share with its Wilson interval, 95 %."""
    if not inside:
        return "-"
    found = binomtest(sum(inside), len(inside)).proportion_ci(method="wilson")
    return f"{np.mean(inside):.1%} ({found.low:.1%} .. {found.high:.1%})"


def main() -> None:
    """Draw, or print what has been drawn."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=100)
    parser.add_argument("--first", type=int, default=1, help="seed of the first draw")
    parser.add_argument("--seconds", type=float, default=30.5, help="of data")
    parser.add_argument("--part", type=Path, help="keeps what has been drawn")
    parser.add_argument("--workers", type=int, default=1, help="0: one per core")
    parser.add_argument("--so-far", type=Path, nargs="+", metavar="PART")
    options = parser.parse_args()
    if options.so_far:
        report(found_in(options.so_far))
        return
    points = [
        {"draw": seed, "seconds": options.seconds} for seed in range(options.first, options.first + options.draws)
    ]
    crew = HERE if options.workers == 1 else Crew(options.workers, None)
    with rounds(draw, {"title": "draws", "worn": WORN}, options.part, crew) as ask:
        report([result for begin in range(0, len(points), CHUNK) for result in ask(points[begin : begin + CHUNK])])


if __name__ == "__main__":
    main()
