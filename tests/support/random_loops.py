"""Sampled loops drawn at random, each at its own critical gain by linear theory."""

import numpy as np

from controller.stability import critical_gain
from controller.stability.actuator.oscillation import PLAIN, Loops

SIDES = np.array([0.9, 0.97, 1.03, 1.1])  # of the critical gain
STARTS = np.array([0.01, 1.0, 10.0, 100.0])[:, None]  # of alpha; the last is 43 % of a chamber's length


def random_loops(seed: int, count: int) -> list[Loops]:
    """Loops with a critical gain s, neither 0 nor infinite; half without derivative gain, half without delay."""
    rng, loops = np.random.default_rng(seed), []
    while len(loops) < count:
        derivative = str(rng.choice(["measured", "backward", "filtered"]))
        numbers = {
            "d": float(rng.choice([0.0, 10.0 ** rng.uniform(-2.0, 0.3)])),
            "k": 10.0 ** rng.uniform(-1.7, 0.3),
            "gamma": 10.0 ** rng.uniform(-1.3, 0.0),
            "tau": 10.0 ** rng.uniform(-0.7, 1.3),
            "delay": float(rng.choice([0.0, rng.uniform(0.0, 3.0)])),
            "derivative": derivative,
            "filter_time": 10.0 ** rng.uniform(-0.5, 0.5) if derivative == "filtered" else None,
        }
        loop = PLAIN._replace(**numbers)
        gain = critical_gain(loop.d, loop.k, loop.gamma, loop.timing)
        if 0.0 < gain < np.inf:
            loops.append(loop._replace(s=gain))
    return loops
