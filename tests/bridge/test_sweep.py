"""Sweeps: the same result whoever computes it, and after an interruption nothing twice."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from bridge.errors import UsageError
from bridge.studies.sweep.engine import HERE, Crew, sweep
from bridge.studies.sweep.journal import Journal, key_of

POINTS = [{"a": i, "b": 0.1 * i} for i in range(7)]
ABOUT = {"title": "squares"}


def square(point: Mapping[str, Any]) -> dict[str, float]:
    return {"square": point["a"] ** 2 + point["b"], "third": point["a"] / 3.0}


def interrupted(point: Mapping[str, Any]) -> dict[str, float]:
    if point["a"] == 4:
        raise KeyboardInterrupt
    return square(point)


def never(point: Mapping[str, Any]) -> dict[str, float]:
    raise AssertionError(f"computed again: {point}")


interrupted.__qualname__ = never.__qualname__ = square.__qualname__  # the same sweep for the journal


def test_one_and_two_workers_and_any_order_give_the_same(tmp_path: Path):
    one = sweep(square, POINTS, ABOUT, tmp_path / "one", HERE)
    assert sweep(square, POINTS, ABOUT, tmp_path / "two", Crew(2, None)) == one
    assert sweep(square, POINTS[::-1], ABOUT, None, HERE) == one[::-1]
    assert [entry["square"] for entry in one] == [p["a"] ** 2 + p["b"] for p in POINTS]
    assert not list(tmp_path.iterdir())


def test_an_interrupted_sweep_goes_on_where_it_was(tmp_path: Path):
    part = tmp_path / "sweep.part"
    with pytest.raises(KeyboardInterrupt):
        sweep(interrupted, POINTS, ABOUT, part, HERE)
    assert len(part.read_text().splitlines()) == 1 + 4
    with pytest.raises(AssertionError, match="'a': 4"):
        sweep(never, POINTS, ABOUT, part, HERE)  # the first four are not asked for again
    assert sweep(square, POINTS, ABOUT, part, HERE) == sweep(square, POINTS, ABOUT, None, HERE)
    assert not part.exists()


@pytest.mark.parametrize("cut", [1, 5, 30])
def test_a_line_cut_off_is_dropped(tmp_path: Path, cut: int):
    path = tmp_path / "j"
    for point in POINTS[:3]:
        Journal(path, ABOUT).add(point, square(point))
    path.write_bytes(path.read_bytes()[:-cut])
    again = Journal(path, ABOUT)
    assert set(again.found) == {key_of(point) for point in POINTS[:2]}
    again.add(POINTS[2], square(POINTS[2]))
    assert Journal(path, ABOUT).found[key_of(POINTS[2])] == square(POINTS[2])


def test_the_journal_of_another_sweep_is_refused(tmp_path: Path):
    Journal(tmp_path / "j", ABOUT).add(POINTS[0], {"square": 0.0})
    with pytest.raises(UsageError, match="remove it"):
        Journal(tmp_path / "j", {"title": "cubes"})
    assert json.loads((tmp_path / "j").read_text().splitlines()[0]) == {"sweep": ABOUT}


def test_a_dask_cluster_gives_the_same(tmp_path: Path):
    distributed = pytest.importorskip("distributed")
    options = {"processes": False, "dashboard_address": None, "threads_per_worker": 1}
    for workers in (1, 2):
        with distributed.LocalCluster(n_workers=workers, **options) as cluster:
            found = sweep(square, POINTS, ABOUT, tmp_path / "p", Crew(0, cluster.scheduler_address))
        assert found == sweep(square, POINTS, ABOUT, None, HERE)
