"""Fits from several starts: where they begin, what is said of where they end, and a minimum that one start misses."""

import math
from pathlib import Path

import numpy as np
import pytest

from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.studies.identification.identify import Wanted, prepared
from bridge.studies.identification.parameters import Parameter
from bridge.studies.identification.starts import FAR, Starts, from_several, places_of
from bridge.studies.sweep.engine import HERE
from tests.tools.identification import SCENARIO


def test_starts_fill_what_is_known_before_evenly_and_keep_limits():
    """One in each of as many slices of each number; the scenario's own is the first."""
    wide = Parameter("a", "kg", 1.0, 0.1, math.inf, 0.0, 2.0)
    narrow = Parameter("b", "kg", 1.0, 0.9, 1.2, 0.0, 0.5)
    first, *others = places_of([wide, narrow], 9)
    assert first == [0.0, 0.0]
    for places, (low, high) in zip(np.array(others).T, [(-FAR, FAR), (math.log(0.9), math.log(1.2))], strict=True):
        slices = np.floor((places - low) / (high - low) * 8)
        assert sorted(slices) == [*range(8)]


def test_where_they_end_is_said_in_one_sentence():
    best = np.zeros(1)
    assert Starts(best, [1.0, 1.01], 2).words == "2 of 2 starts end in the same minimum"
    said = "1 of 3 starts end in the same minimum, the others up to 4 times as far from the data"
    assert Starts(best, [4.0, 1.0, None], 1).words == f"{said}; the scenario's own does not"


def test_another_start_finds_the_minimum_that_the_scenario_s_own_misses(tmp_path: Path):
    """A bulk modulus of a thirteenth: slopes from there lead astray."""
    scenario = load(str(SCENARIO), ["duration=2 s"])
    record_in_process(scenario, tmp_path / "run.mcap")
    off = load(str(SCENARIO), ["duration=2 s", "rig.oil.bulk_modulus=1e8"]).model_dump(mode="json")
    wanted = Wanted((str(tmp_path / "run.mcap"),), (), off, ("rig.oil.bulk_modulus",))
    parameters = prepared(wanted).parameters
    found = from_several(wanted, parameters, 4, tmp_path / "starts.part", HERE)
    assert found.rms[0] is not None
    assert found.rms[0] > 5.0  # deviations of the noise
    assert min(value for value in found.rms if value is not None) < 1.05
    assert parameters[0].value(found.best[0]) == pytest.approx(scenario.rig.oil.bulk_modulus, rel=0.01)
    assert "the scenario's own does not" in found.words
