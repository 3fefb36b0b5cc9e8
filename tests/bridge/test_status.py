"""A plant's status: names and numbers on the wire and the value with types say the same; and who is there."""

import math
import os
from types import SimpleNamespace

import numpy as np

from bridge.processes.statuses import THERE, silent
from bridge.wire.messages import Phase
from bridge.wire.status import Pace, PlantReport, PlantStatus, Reading, plant_status

WHOLE = PlantStatus(
    tick=5,
    ticks=10,
    commands=4,
    late=1,
    worst_late=2e-3,
    safe_states=1,
    reading=Reading(0.1, (1e5, 2e5, 3e5), -0.5),
    refused={"stale": 3},
    pace=Pace(2, 0.01, 3, 1e-4, -1e-9, 5),
    published={"state": 6, "pressure/p1": 1},
)
NAMES = (
    *("tick", "ticks", "commands", "late", "worst_late", "safe_states", "position", "p1", "p2", "p3", "spool"),
    *("refused/stale", "overruns", "worst_overrun", "longest_burst", "lateness", "round_trip", "late_ticks"),
    *("published/state", "published/pressure/p1"),
)


def message(values: dict[str, float], role: str = "plant") -> SimpleNamespace:
    """A status message as it is decoded."""
    return SimpleNamespace(role=role, names=list(values), values=np.array([float(v) for v in values.values()]))


def test_names_and_their_order_are_those_of_recorded_messages():
    assert tuple(WHOLE.plain()) == NAMES
    assert tuple(PlantReport(WHOLE, Phase.ENDED, "").plain()) == (*NAMES, "phase", "reason")


def test_a_status_comes_back_from_its_message():
    assert plant_status(message(WHOLE.plain())) == WHOLE
    lean = PlantStatus(5, 10)
    assert plant_status(message(lean.plain())) == lean
    assert plant_status(message(WHOLE.plain(), "recorder")) is None


def test_a_foreign_plant_may_say_less_or_nonsense():
    assert plant_status(message({"tick": 7.0})) == PlantStatus(7, 0, commands=None)
    assert plant_status(message({"tick": math.nan, "p1": 1e5})) == PlantStatus(0, 0, commands=None)
    assert PlantStatus.from_plain({"overruns": 1.0}).pace == Pace(1, 0.0, 0, 0.0, -1.0, 0)


def test_those_that_say_nothing_are_listed_as_there():
    """By their signs of life; a replay's has no number, our own is not told."""
    present = {"controller": {"12"}, "plant": {"11"}, "replay": {"replay"}, "viewer": {str(os.getpid())}}
    found = {(each.role, each.pid, each.phase) for each in silent(present, {"11"})}
    assert found == {("controller", 12, THERE), ("replay", 0, THERE)}
