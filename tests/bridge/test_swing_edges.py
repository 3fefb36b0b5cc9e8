"""The table of edges: how a map of the twin is filled, and shares over a sample of cases."""

import math

import pytest

from controller.stability.amplitude.swing import LARGEST, Swing
from tests.benchmarks.swing_edges.cases import LAWS, first_of_each
from tests.benchmarks.swing_edges.gain_map import COARSE, DOWN, MARGIN, GainMap, edges_of, fill, read, record, write
from tests.benchmarks.swing_edges.table import asked, row_of

CASES = first_of_each(tuple(LAWS), 8)  # of each law, half of them of each mass: 64
LAST = 200


def filled(islands: tuple[range, ...], one_sided: bool) -> GainMap:
    """A map of a loop that swings at the places of some islands, from coarse runs over all."""
    runs: dict[int, Swing] = {}

    def swings(k: int) -> bool:
        runs[k] = Swing(2.0 * LARGEST, float(k)) if any(k in island for island in islands) else Swing(0.0, 0.0)
        return runs[k].counts

    fill(swings, range(0, LAST, COARSE), LAST, one_sided)
    return GainMap(one_sided, {float(k): runs[k] for k in sorted(runs)})


def test_the_edge_of_a_map_is_the_lowest_gain_that_swings():
    """Here of an island that the coarse runs step over, and the next below it, and none further down."""
    islands = (range(100 - DOWN // 2, 101 - DOWN // 2), range(98, 101), range(110, LAST))
    found = filled(islands, one_sided=True)
    lowest = float(100 - DOWN // 2)
    assert edges_of(found)[2:5] == (lowest - 1.0, lowest, lowest)
    assert set(range(100 - DOWN - DOWN // 2, 100 + MARGIN)) <= {round(gain) for gain in found.runs}


def test_the_band_of_a_map_is_the_widest_stretch_that_settles():
    """An island in the middle of what the coarse runs show as a band cuts it."""
    found = filled((range(40), range(90, 92), range(150, LAST)), one_sided=False)
    edges = edges_of(found)
    assert (edges.least_swings, edges.least_settles, edges.settles, edges.swings) == (91.0, 92.0, 149.0, 150.0)


def test_a_map_without_an_edge():
    for one_sided in (True, False):
        assert edges_of(filled((), one_sided)).swings == math.inf
        assert edges_of(filled((range(LAST),), one_sided)).settles == 0.0


def test_a_map_comes_back_from_its_file(tmp_path):
    found = filled((range(100, LAST),), one_sided=True)
    write(tmp_path / "a.maps", CASES[0], found)
    assert read(tmp_path / "a.maps") == {CASES[0]: found}


@pytest.mark.endurance
@pytest.mark.timeout(7200)
def test_most_edges_lie_in_narrow_intervals():
    """Shares less than what `docs/stability.md` says by what chance does to so few: two standard deviations."""
    rows = [row_of(case, asked(case), record(case)) for case in CASES]
    edges = [row for row in rows if row.has_edge]
    swinging = [row for row in edges if row.edges.frequency > 0.0]
    for row in rows:
        print(*row.case, row.edges, row.expected, row.inside)
    assert len(edges) >= 40
    assert sum(row.inside for row in edges) >= least(0.9, len(edges))
    assert sum(row.expected.width <= 2.001 for row in edges) >= least(0.7, len(edges))
    assert sum(row.often for row in swinging) >= least(0.7, len(swinging))


def least(share: float, count: int) -> float:
    """How many of a count, with a share of them expected."""
    return share * count - 2.0 * math.sqrt(share * (1.0 - share) * count)
