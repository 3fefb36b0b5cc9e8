"""Logs in CSV become recordings: right to a stated precision, or refused in one sentence."""

import gzip
import math

import numpy as np
import pytest

from bridge.errors import UsageError
from bridge.recording.imported import facts
from bridge.recording.logs.importing import import_log, imported
from bridge.recording.logs.map import parsed_map
from bridge.recording.logs.measured import measured
from bridge.recording.reader import read
from bridge.runs.in_process import run_in_memory
from bridge.scenario import load
from tests.support.csv_log import (
    BAR,
    MAP,
    MM,
    PRINTED,
    PRINTED_BAR,
    ROWS,
    TIME,
    VOLTS,
    assert_right,
    refused,
    taken,
    text,
)


def test_plain_csv(tmp_path):
    made = taken(tmp_path, text())
    assert_right(made)
    rows = facts(made.recording)["rows"]
    assert rows == {"read": ROWS, "duplicate": 0, "out of order": 0, "without a time": 0, "counter began again": 0}


def test_gzip(tmp_path):
    assert_right(taken(tmp_path, gzip.compress(text().encode()), "log.csv.gz"))


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "cp1252"])
def test_spreadsheet_in_german(tmp_path, encoding):
    """Semicolons, decimal commas, a mark at the beginning, carriage returns, and units in brackets."""
    content = text(head="Zeit [s];u;Länge [mm];Druck [bar]", comma=",", sign=";", end="\r\n").encode(encoding)
    assert_right(taken(tmp_path, content, time="Zeit", position="Länge", p2="Druck"))


def test_tabs_and_a_first_line_that_says_so(tmp_path):
    assert_right(taken(tmp_path, "sep=;\r\n" + text(sign=";")))
    assert_right(taken(tmp_path, text(sign="\t")))


def test_spaces_with_decimal_commas(tmp_path):
    assert_right(taken(tmp_path, text(head="t_s  u x_mm p_bar", sign="   ", comma=",")))


def test_comments_before_the_head(tmp_path):
    assert_right(taken(tmp_path, "# logger 3, serial 12\n# rig: axis 7, 2026-03-01\n\n" + text()))


def test_units_in_a_second_row(tmp_path):
    content = text(head="t,u,x,p\n[s],[V],[mm],[bar]")
    assert_right(taken(tmp_path, content, time="t", position="x", p2="p"))


def test_no_head(tmp_path):
    content = text().split("\n", 1)[1]
    where = {"time": "column1", "clock": 'unit = "s"', "position": "column3", "p2": "column4"}
    more = MAP.format(**where).replace('"u"', '"column2"').replace('"column3"', '"column3"\nunit = "mm"')
    path = tmp_path / "bare.csv"
    path.write_text(content)
    mapped = parsed_map(more.replace('"column4"', '"column4"\nunit = "bar"'), "map")
    assert_right(imported(path, mapped, tmp_path / "map.toml"))


def test_milliseconds_with_jitter(tmp_path):
    """Rows up to 0.3 ms off the grid, each with the value of its own instant: a straight line between them."""
    off = np.random.default_rng(1).uniform(-0.3, 0.3, ROWS)
    off[[0, -1]] = 0.0
    at = TIME + off * 1e-3
    rows = zip(
        at * 1e3,
        VOLTS,
        135.0 + 20.0 * np.sin(6.0 * math.pi * at),
        60.0 + 10.0 * np.cos(6.0 * math.pi * at),
        strict=True,
    )
    content = "t_ms,u,x_mm,p_bar\n" + "".join(f"{t:.6f},{u:.3f},{x:.6f},{p:.6f}\n" for t, u, x, p in rows)
    found = measured(taken(tmp_path, content, time="t_ms").recording)
    bend = 20e-3 * (6.0 * math.pi) ** 2 * 1.6e-3**2 / 8.0  # [m]: a chord over the longest interval misses by this
    assert np.abs(found.signals["position"] - MM * 1e-3).max() < bend + 1e-9
    jitter = facts(taken(tmp_path, content, time="t_ms").recording)["time"]["jitter"]
    assert jitter == pytest.approx(np.abs(np.diff(at) - np.median(np.diff(at))).max(), abs=1e-8)


def test_times_of_day_and_dates_with_a_time_zone(tmp_path):
    seconds = [f"{k / 1000:09.6f}" for k in range(ROWS)]
    assert_right(taken(tmp_path, text([f"2026-03-29T01:59:{s}+01:00" for s in seconds]), clock='unit = "text"'))
    assert_right(taken(tmp_path, text([f"29.03.2026 01:59:{s}" for s in seconds])))
    over = [f"23:59:59.{k + 800:03d}" if k < 200 else f"00:00:00.{k - 200:03d}" for k in range(ROWS)]
    assert_right(taken(tmp_path, text(over)))


def test_the_hour_that_summer_time_leaves_out_is_no_gap(tmp_path):
    """With a time zone the clock goes on: 01:59:59.9 +01:00 is followed by 03:00:00.0 +02:00."""
    times = [f"2026-03-29T01:59:59.{k + 800:03d}+01:00" for k in range(200)]
    times += [f"2026-03-29T03:00:00.{k:03d}+02:00" for k in range(ROWS - 200)]
    assert_right(taken(tmp_path, text(times)))


def test_dates_by_a_format_of_ones_own(tmp_path):
    times = [f"03/29/2026 10:00:00.{k:03d}" for k in range(ROWS)]
    assert_right(taken(tmp_path, text(times), clock='format = "%m/%d/%Y %H:%M:%S.%f"'))
    assert "03/29/2026" in refused(tmp_path, text(times))


def test_a_counter_of_time_that_begins_again(tmp_path):
    ticks = [str((65_400 + k) % 65_536) for k in range(ROWS)]
    assert_right(taken(tmp_path, text(ticks, "n,u,x_mm,p_bar"), time="n", clock='unit = "ms"\nwrap = 65536'))
    words = refused(tmp_path, text(ticks, "n,u,x_mm,p_bar"), time="n", clock='unit = "ms"')
    assert "wrap" in words
    assert "65535" in words


def test_a_counter_of_position_that_begins_again(tmp_path):
    """An encoder of 8 bits and 0.1 mm a step, past its end and back."""
    steps = np.round(MM * 10.0).astype(int) % 256
    content = "t_s,u,n,p_bar\n" + "".join(
        f"{t:.3f},{u:.3f},{n},{p:.3f}\n" for t, u, n, p in zip(TIME, VOLTS, steps, BAR, strict=True)
    )
    own = 'scale = 1e-4\nunit = ""\nwrap = 256\noffset = "128 mm"'
    assert np.abs(np.diff(steps)).max() > 200
    made = taken(tmp_path, content, position=f'n"\n{own}\nmethod = "nearest', p2="p_bar")
    found = measured(made.recording).signals["position"]
    assert np.abs(found - MM * 1e-3).max() <= 0.5e-4 * 1.001


def test_duplicates_and_rows_out_of_order(tmp_path):
    rows = [*range(ROWS)]
    rows[100], rows[101] = rows[101], rows[100]
    rows.insert(200, 200)
    made = taken(tmp_path, text(rows=rows))
    assert_right(made)
    counted = facts(made.recording)["rows"]
    assert (counted["read"], counted["duplicate"], counted["out of order"]) == (ROWS + 1, 1, 1)


def test_rows_in_no_order_at_all(tmp_path):
    rows = np.random.default_rng(2).permutation(ROWS).tolist()
    assert "sort" in refused(tmp_path, text(rows=rows))
    assert_right(taken(tmp_path, text(rows=rows), clock="sort = true"))


def test_a_short_gap_is_bridged_and_a_long_one_stays_missing(tmp_path):
    """Three intervals are the limit: of 2 missing rows a line is drawn, of 30 nothing is invented."""
    rows = [k for k in range(ROWS) if k not in (50, 51) and not 300 <= k < 330]
    made = taken(tmp_path, text(rows=rows))
    found = measured(made.recording)
    for values in (found.command, found.signals["position"], found.signals["p2"]):
        assert np.flatnonzero(np.isnan(values)).tolist() == [*range(300, 330)]
    assert found.signals["position"][50] == pytest.approx(MM[50] * 1e-3, abs=8.0 * 1e-6)  # 0.9 um of bend, times 9
    told = facts(made.recording)["signals"]["position"]
    assert told["missing"] == 30
    assert told["holes"] == [[pytest.approx(0.3), pytest.approx(0.329)]]
    wide = taken(tmp_path, text(rows=rows), p2='p_bar"\ngap = "50 ms')
    assert not np.isnan(measured(wide.recording).signals["p2"]).any()


def test_missing_cells_are_counted(tmp_path):
    lines = text().split("\n")
    for k in range(20, 40):
        lines[k] = ",".join([*lines[k].split(",")[:2], "", "n/a"])
    made = taken(tmp_path, "\n".join(lines))
    found = measured(made.recording)
    assert np.isnan(found.signals["position"]).sum() == 20
    assert not np.isnan(found.command).any()
    assert facts(made.recording)["signals"]["p2"]["empty"] == 20


def test_text_in_a_column_of_numbers_is_refused_or_counted(tmp_path):
    lines = text().split("\n")
    lines[120] = lines[120].rsplit(",", 1)[0] + ",Overrange"
    words = refused(tmp_path, "\n".join(lines))
    assert "'Overrange'" in words
    assert "line 121" in words
    made = taken(tmp_path, "\n".join(lines), clock='[log]\nmissing = ["Overrange"]')
    assert facts(made.recording)["signals"]["p2"]["empty"] == 1


def test_a_last_row_that_was_cut_off_is_left_out(tmp_path):
    made = taken(tmp_path, text() + "0.400,2.5")
    assert_right(made)
    assert "line 402" in facts(made.recording)["notes"][0]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is empty"),
        (b"\n\n  \n", "is empty"),
        (b"t_s,u,x_mm,p_bar\n", "no rows of numbers"),
        (b"\x00\x01\x02\x03" * 100, "not a text"),
        (gzip.compress(text().encode())[:40], "gzip that is cut off after"),
        (gzip.compress(text().encode())[:-8] + bytes(8), "gzip that is damaged"),
        (text(head="t_s,u,way_mm,p_bar").encode(), "no column 'x_mm'; did you mean"),
        (text(head="t_s,u,x,p_bar").encode(), "no column 'x_mm'"),
        (text(rows=range(1)).encode(), "two"),
    ],
)
def test_what_is_no_log_is_refused_in_one_sentence(tmp_path, content, words):
    assert words in refused(tmp_path, content)


def test_units_are_never_guessed(tmp_path):
    assert "has no unit" in refused(tmp_path, text(head="t_s,u,x,p_bar"), position="x")
    assert "is in bar" in refused(tmp_path, text(), position="p_bar")
    volts = "\n[signal.reference]\ncolumn = 'u'\nunit = 'V'"
    assert "say `scale`, m per V" in refused(tmp_path, text(), more=volts)
    assert "whole travel" in refused(tmp_path, text(head="t_s,z,x_mm,u"), p2='z"\nunit = "bar')


def test_sign_scale_offset_and_delay(tmp_path):
    """A rod that grows as it retracts, absolute pressures, and a transducer that is 3 ms late."""
    own = 'x_mm"\nsign = -1\noffset = "270 mm'
    late = 'p_bar"\nunit = "bar abs"\ndelay = "3 ms'
    found = measured(taken(tmp_path, text(), position=own, p2=late).recording)
    assert np.abs(found.signals["position"] - (0.27 - MM * 1e-3)).max() <= PRINTED * 1.001
    assert np.abs(found.signals["p2"][:-3] - (BAR[3:] - 1.0) * 1e5).max() <= PRINTED_BAR * 1.001
    assert np.isnan(found.signals["p2"][-3:]).all()


def test_methods(tmp_path):
    """At 0.25 ms between rows of 1 ms: on a line, the row before, the nearer row (in the middle the later one)."""
    grid = MAP.replace('"1 ms"', '"0.25 ms"')
    lines = "t_s,u,x_mm,p_bar\n" + "".join(f"{k / 1000},{k / 10},{k},{k}\n" for k in range(10))
    (tmp_path / "log.csv").write_text(lines)
    ways = {"linear": [0.0, 0.25, 0.5, 0.75, 1.0], "previous": [0.0] * 4 + [1.0], "nearest": [0.0, 0.0, 1.0, 1.0, 1.0]}
    for method, expected in ways.items():
        own = grid.format(time="t_s", clock="", position=f'x_mm"\nmethod = "{method}', p2="p_bar")
        made = imported(tmp_path / "log.csv", parsed_map(own, "map"), tmp_path / "map.toml")
        found = measured(made.recording)
        assert (found.signals["position"][:5] * 1e3).tolist() == pytest.approx(expected)
        assert found.command[:5].tolist() == pytest.approx([0.0] * 4 + [0.01])  # held


def test_the_same_log_and_map_make_the_same_bytes(tmp_path):
    first, again = (taken(tmp_path, text()).recording for _ in range(2))
    assert first.entries == again.entries


def test_a_recording_of_ours_gives_the_same_arrays_as_its_messages():
    """`measured` of a run: the card's channels, the command in force, and the card's noise."""
    run = run_in_memory(load("step", ["duration=0.3", "loop.delay=5 ms", "daq.channels=['p_p']"]))
    found = measured(run)
    read_by_card, sent = run.columns("measurement"), run.columns("command")
    assert found.simulated
    assert (found.signals["p2"] == read_by_card["p2"]).all()
    assert set(found.signals) == {"position", "velocity", "p1", "p2", "p3", "p_p"}
    assert found.command[:5].tolist() == [0.0] * 5
    assert found.command[5:15].tolist() == [sent["spool"][0]] * 10
    assert found.sensors["position"].quantum == pytest.approx(0.3 / 4096)
    assert found.sensors["position"].noise == pytest.approx(0.5 * 0.3 / 4096)
    assert found.sensors["position"].rms == pytest.approx(0.3 / 4096 * math.sqrt(0.25 + 1.0 / 12.0))


def test_noise_is_stated_or_estimated(tmp_path):
    """White noise of 0.2 bar on a slow swing is found within 10 %: 400 second differences have a spread of 6 %."""
    noisy = BAR + np.random.default_rng(3).normal(0.0, 0.2, ROWS)
    lines = zip(TIME, VOLTS, MM, noisy, strict=True)
    content = "t_s,u,x_mm,p_bar\n" + "".join(f"{t:.3f},{u},{x:.3f},{p:.6f}\n" for t, u, x, p in lines)
    own = 'x_mm"\nrange = ["0 mm", "300 mm"]\nbits = 12\nnoise = "0.5 LSB'
    sensors = measured(taken(tmp_path, content, position=own).recording).sensors
    assert sensors["position"] == (pytest.approx(0.15 / 4096), pytest.approx(0.3 / 4096), True, 0.0, 0.3)
    assert not sensors["p2"].stated
    assert sensors["p2"].rms == pytest.approx(0.2e5, rel=0.2)


def test_the_file_reads_back_as_it_was_made(tmp_path):
    (tmp_path / "log.csv").write_text(text())
    map_path = tmp_path / "map.toml"
    map_path.write_text(MAP.format(time="t_s", clock="", position="x_mm", p2="p_bar"))
    made = import_log(tmp_path / "log.csv", map_path, tmp_path / "run.mcap")
    back = read(tmp_path / "run.mcap")
    assert back.entries == made.recording.entries
    assert back.metadata["imported"] == made.recording.metadata["imported"]
    assert back.scenario() == made.scenario
    with pytest.raises(UsageError, match="overwritten"):
        import_log(tmp_path / "log.csv", map_path, tmp_path / "log.csv")
