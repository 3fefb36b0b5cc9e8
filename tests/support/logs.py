"""Logs as other programs leave them, made for tests: one motion, and the map that reads it back."""

import math
from pathlib import Path

import numpy as np

from bridge.recording.logs.importing import Made, imported
from bridge.recording.logs.map import parsed_map
from bridge.recording.logs.measured import measured

ROWS = 400
TIME = np.arange(ROWS) * 1e-3  # [s]
VOLTS = np.where(TIME < 0.1, 0.0, 2.5)
MM = 135.0 + 20.0 * np.sin(2.0 * math.pi * 3.0 * TIME)
BAR = 60.0 + 10.0 * np.cos(2.0 * math.pi * 3.0 * TIME)
EXACT = 1e-12  # [m], of numbers that a file keeps as they are

MAP = """
rig = "ehla"
period = "1 ms"
{time}
[signal.command]
column = "{u}"
unit = "V"
scale = 0.1
[signal.position]
column = "{x}"
unit = "mm"
[signal.p2]
column = "{p}"
unit = "bar"
"""


def made_of(path: Path, u: str, x: str, p: str, time: str = "") -> Made:
    """The recording of a log, in memory; u, x, p: the columns of volts, mm and bar."""
    return imported(path, parsed_map(MAP.format(u=u, x=x, p=p, time=time), "map"), path.parent / "map.toml")


def assert_exact(made: Made) -> None:
    """Every instant of the grid has what the log says, in SI."""
    found = measured(made.recording)
    assert len(found.times) == ROWS
    assert np.abs(found.signals["position"] - MM * 1e-3).max() <= EXACT
    assert np.abs(found.signals["p2"] - BAR * 1e5).max() <= EXACT * 1e8
    assert np.abs(found.command - VOLTS / 10.0).max() <= EXACT
