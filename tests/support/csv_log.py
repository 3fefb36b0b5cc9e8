"""A log in CSV, its map, and what a recording of it should hold."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from bridge.errors import UsageError
from bridge.recording.logs.importing import Made, imported
from bridge.recording.logs.map import parsed_map
from bridge.recording.logs.measured import measured

MAP = """
rig = "ehla"
period = "1 ms"
[time]
column = "{time}"
{clock}
[signal.command]
column = "u"
unit = "V"
scale = 0.1
[signal.position]
column = "{position}"
[signal.p2]
column = "{p2}"
"""
ROWS = 400
TIME = np.arange(ROWS) * 1e-3
VOLTS = np.where(TIME < 0.1, 0.0, 2.5)
MM = 135.0 + 20.0 * np.sin(2.0 * math.pi * 3.0 * TIME)  # its curvature: 0.5 dt^2 20 (6 pi)^2 / 4 = 0.9 um in 1 ms
BAR = 60.0 + 10.0 * np.cos(2.0 * math.pi * 3.0 * TIME)
PRINTED = 5e-7  # [m], of a position printed to 1 um
PRINTED_BAR = 50.0  # [Pa], of a pressure printed to 1 mbar


def text(time=None, head="t_s,u,x_mm,p_bar", comma=".", sign=",", rows: Sequence[int] = range(ROWS), end="\n") -> str:
    """A log as a logger prints it."""
    time = [f"{t:.6f}" for t in TIME] if time is None else time
    lines = [head if sign in head else head.replace(",", sign)]
    for k in rows:
        cells = (time[k], f"{VOLTS[k]:.3f}", f"{MM[k]:.3f}", f"{BAR[k]:.3f}")
        lines.append(sign.join(cell.replace(".", comma) if comma != "." else cell for cell in cells))
    return end.join(lines) + end


def taken(folder: Path, content: str | bytes, name: str = "log.csv", more: str = "", **where: str) -> Made:
    """The recording of a log, in memory."""
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    names = {"time": "t_s", "clock": "", "position": "x_mm", "p2": "p_bar"} | where
    return imported(path, parsed_map(MAP.format(**names) + more, "map"), folder / "map.toml")


def assert_right(made: Made, tolerance: float = PRINTED, pressure: float = PRINTED_BAR) -> None:
    """Every instant of the grid has what the log says, in SI."""
    found = measured(made.recording)
    assert len(found.times) == ROWS
    assert np.abs(found.signals["position"] - MM * 1e-3).max() <= tolerance * 1.001
    assert np.abs(found.signals["p2"] - BAR * 1e5).max() <= pressure * 1.001
    assert found.command == pytest.approx(VOLTS / 10.0, abs=1e-12)


def refused(folder: Path, content: str | bytes, **more) -> str:
    with pytest.raises(UsageError) as found:
        taken(folder, content, **more)
    assert "\n" not in str(found.value)
    return str(found.value)
