"""Two ways of running the loop in turns: what the plant can notice of the second."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from tests.benchmarks.plant import Row

TURNS = 4
Summary = dict[str, Any]


def in_turns(alone: Callable[[], Summary], beside: Callable[[], Summary]) -> tuple[list[Summary], list[Summary]]:
    """Summaries of real-time runs, the two ways one after the other."""
    pairs = [(alone(), beside()) for _ in range(TURNS)]
    return [a for a, _ in pairs], [b for _, b in pairs]


def compared(alone: list[Summary], beside: list[Summary], quantiles: tuple[str, ...], words: str) -> Iterator[Row]:
    """Lateness and round trip: medians of the turns, and how far those alone are apart."""
    for quantity in ("lateness", "round_trip"):
        for quantile in quantiles:
            plain, other = ([1e6 * run["timing"][quantity][quantile] for run in runs] for runs in (alone, beside))
            ratio = float(np.median(other) / max(np.median(plain), 1e-3))
            spread = f"{np.median(plain):.1f} us alone ({min(plain):.1f} .. {max(plain):.1f})"
            found = f"{np.median(other):.1f} us ({min(other):.1f} .. {max(other):.1f})"
            yield f"{quantity.replace('_', ' ')} {quantile}, {words}", found, spread, f"{ratio:.2f}"
