"""The table of edges over a sample of its cases: shares of those inside, of narrow intervals, of frequencies."""

import math

import pytest

from tests.benchmarks.swing_edges import LAWS, first_of_each, measured

CASES = first_of_each(tuple(LAWS), 8)  # of each law, half of them of each mass: 56


@pytest.mark.endurance
@pytest.mark.timeout(7200)
def test_most_edges_lie_in_narrow_intervals():
    """Shares less than what `docs/stability.md` says by what chance does to so few: two standard deviations."""
    rows = [measured(case) for case in CASES]
    edges = [row for row in rows if row.has_edge]
    swinging = [row for row in edges if row.frequency > 0.0]
    for row in rows:
        print(*row.case, row.settles, row.swings, row.low, row.high, row.inside, row.frequency, row.predicted)
    assert len(edges) >= 40
    assert sum(row.inside for row in edges) >= least(0.9, len(edges))
    assert sum(row.width <= 2.0 for row in edges) >= least(0.7, len(edges))
    assert sum(row.often for row in swinging) >= least(0.7, len(swinging))


def least(share: float, count: int) -> float:
    """How many of a count, with a share of them expected."""
    return share * count - 2.0 * math.sqrt(share * (1.0 - share) * count)
