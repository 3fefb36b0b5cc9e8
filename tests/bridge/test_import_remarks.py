"""What an import makes of a log that is not whole or does not fit its map: where its recording starts, what is said."""

import gzip
import zlib
from pathlib import Path

import numpy as np
import pytest

from bridge.errors import UsageError
from bridge.recording.imported import facts
from bridge.recording.logs.importing import imported
from bridge.recording.logs.map import parsed_map
from bridge.recording.logs.measured import measured
from bridge.scenario import load
from tests.support.csv_log import (
    MAP,
    MM,
    PRINTED,
    taken,
    text,
)


def test_of_an_archive_that_was_cut_off_the_whole_lines_are_read(tmp_path):
    """The number of bytes that is told is what gzip itself gets out of it."""
    packed = gzip.compress(text().encode())[:-2000]
    there = zlib.decompressobj(31).decompress(packed)
    made = taken(tmp_path, packed, "log.csv.gz")
    found = measured(made.recording)
    assert len(found.times) == there.count(b"\n") - 1  # without the head
    assert np.abs(found.signals["position"] - MM[: len(found.times)] * 1e-3).max() <= PRINTED
    assert facts(made.recording)["notes"][0].endswith(f"{len(there)} bytes")


def started(folder: Path, first: str, more: str = "", **where: str) -> tuple[float, float]:
    """Position [m] and upper pressure [bar] at which a recording starts; first: of its first rows x [mm] and p3."""
    head, *rows = text(head="t_s,u,x_mm,p_bar,p3_bar").splitlines()
    rows = [f"{row},{100 + k}" for k, row in enumerate(rows)]
    cells = [row.split(",") for row in rows]
    for k, pair in enumerate(first.split(";")):
        x, p = pair.split(",")
        cells[k][2], cells[k][4] = x, p
    made = taken(folder, "\n".join([head, *map(",".join, cells)]), more=more, **where)
    return made.scenario.start.position, made.scenario.start.p_upper / 1e5


P3 = '[signal.p3]\ncolumn = "p3_bar"\n'


def test_a_recording_starts_where_it_was_first_measured(tmp_path):
    """A first sample that is missing is not one; a rod that noise puts beyond its stop is at the stop."""
    assert started(tmp_path, "0,12", P3) == (0.0, 12.0)
    assert started(tmp_path, "NaN,NaN;NaN,NaN;3,103", P3) == (pytest.approx(0.003), 103.0)
    assert started(tmp_path, "-0.02,-0.1", P3) == (0.0, 0.0)
    stroke = load("ehla").rig.cylinder.stroke
    assert started(tmp_path, f"{stroke * 1.009e3},1", P3)[0] == stroke
    with pytest.raises(UsageError, match="outside the stroke"):
        started(tmp_path, f"{stroke * 1.02e3},1", P3)
    upper = "[scenario.start]\np_upper = '7 bar'\n"
    assert started(tmp_path, "5,1", upper) == (pytest.approx(0.005), 7.0)  # no p3: as the scenario has it


def test_a_grid_that_leaves_rows_out_and_a_range_that_is_too_small_are_said(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(text())
    wanted = MAP.format(time="t_s", clock="", position="x_mm", p2="p_bar").replace('"1 ms"', '"0.1"', 1)
    wanted = wanted.replace('"x_mm"', '"x_mm"\nrange = ["0 mm", "150 mm"]')
    notes = facts(imported(path, parsed_map(wanted, "map"), path).recording)["notes"]
    assert "4 instants, and the log 400 rows" in notes[0]
    assert "396 rows are left out" in notes[0]
    assert "position goes from" in notes[1]
    assert "to 154 mm, beyond the range that the map states, 0 to 150 mm" in notes[1]
    right = MAP.format(time="t_s", clock="", position="x_mm", p2="p_bar").replace(
        '"x_mm"', '"x_mm"\nrange = [0, 0.155]'
    )
    assert not facts(imported(path, parsed_map(right, "map"), path).recording)["notes"]
