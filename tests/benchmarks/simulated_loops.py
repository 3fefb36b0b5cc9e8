"""Runs of the nonlinear sampled loop: how many a second, beside Hopsan's 72 ms for 10 s of a circuit like ours; and how
often they agree with linear theory at its edge, with the cause of every disagreement.

10 s are 1362 units of time at 136.2 rad/s, the rig of Table 5.1.
"""

import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from controller.stability import Timing
from controller.stability.actuator.disagreement import causes
from controller.stability.actuator.model import TABLE_5_1, Actuator, omega
from controller.stability.actuator.oscillation import oscillations
from controller.stability.actuator.simulate import (
    ALPHA,
    controller,
    displaced,
    simulate,
)
from tests.benchmarks.plant import Row
from tests.benchmarks.sweeps import HOPSAN
from tests.support.random_loops import SIDES, STARTS, random_loops

SECONDS = 10.0
CASES = {
    "dies away": (3.0, 2.2),
    "small swing": (3.0, 2.45),
    "wide swing": (10.0, 3.0),
    "valve at its limit": (20.0, 5.0),
}
LOOPS = 200


def rows(folder: Path) -> Iterator[Row]:
    """One run of 10 s each, from a displacement of 10 alpha, on one core; then the edges of random loops."""
    plant, last = Actuator(ALPHA, 0.23, 0.1), SECONDS * omega(TABLE_5_1)
    for name, (tau, s) in CASES.items():
        took, loop = float("inf"), controller(s, 0.0, Timing(tau))
        for _ in range(20):
            start = time.process_time()  # of the core: other processes do not count
            simulate(displaced(10.0 * ALPHA), plant, loop, round(last / tau))
            took = min(took, time.process_time() - start)
        words = f"{1.0 / took:.0f} runs of 10 s a second, {took * 1e3:.1f} ms each"
        yield f"nonlinear loop, {name}, tau {tau:g}, s {s:g}", words, "Hopsan: 72 ms", f"{HOPSAN / took:.1f}"
    yield from edges(LOOPS)


def edges(count: int) -> Iterator[Row]:
    """Agreement of runs with theory, by start and side."""
    found, begin, runs = Counter(), time.perf_counter(), count * SIDES.size * STARTS.size
    for loop in random_loops(5, count):
        at = loop._replace(s=SIDES * loop.s, start=STARTS)
        said = causes(at, oscillations(at))
        found.update((row, column, str(said[row, column])) for row, column in np.ndindex(said.shape))
    for row, start in enumerate(STARTS[:, 0]):
        for column, side in enumerate(SIDES):
            agree = found[row, column, ""]
            why = ", ".join(
                f"{cause} {n}" for (r, c, cause), n in sorted(found.items()) if (r, c) == (row, column) and cause
            )
            yield (
                f"start {start:g} alpha, {side:g} of critical gain",
                f"{agree} of {count} agree",
                why,
                f"{agree / count:.1%}",
            )
    yield f"{runs} runs and their causes", f"{time.perf_counter() - begin:.0f} s", "", ""
