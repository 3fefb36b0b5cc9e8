"""A measured recording goes through every verb, and the twin under its commands gives what was measured."""

import json
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import hydrotwin
from bridge.recording.imported import facts, is_measured
from bridge.recording.logs.importing import import_log
from bridge.recording.logs.map import load_map
from bridge.recording.reader import read
from bridge.recording.seen import judged, seen
from bridge.runs.in_process import run_in_memory
from bridge.scenario import load
from tests.support.command import hydrotwin_here
from tests.support.processes import ENVIRONMENT

STEP = Path(__file__).parents[2] / "recordings" / "step.mcap"
EXAMPLE = Path(__file__).parents[2] / "examples" / "import" / "foreign-rig.toml"
HELD, LOST = range(500, 600), range(700, 900)  # rows without a position, rows that are not there
MOVED = ["duration=1.2", "start.position=100 mm", "reference.mean=110 mm", "reference.amplitude=10 mm"]


def log_of_a_run(path: Path, *left_out: int) -> None:
    """The twin as a rig that somebody else logs: volts, mm and bar, printed to 1 mV, 1 um and 1 mbar."""
    run = run_in_memory(load("ehla", ["daq.channels=['p_p']", "controller.gain=10 1/m", *MOVED]))
    measured, further, sent = run.columns("measurement"), run.columns("channels"), run.columns("command")
    lines = ["time_s,valve_command,position_mm,p_supply_bar,p_A_bar,p_B_bar"]
    for k in range(len(sent["spool"])):
        if k in left_out:
            continue
        bars = (further["p_p"][k] / 1e5, measured["p2"][k] / 1e5, measured["p3"][k] / 1e5)
        x = "" if k in HELD and left_out else f"{measured['position'][k] * 1e3:.4f}"
        lines.append(f"{k / 1000:.3f},{10.0 * sent['spool'][k]:.6f},{x}," + ",".join(f"{bar:.4f}" for bar in bars))
    path.write_text("\n".join(lines))


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """whole.mcap of a log without holes, holes.mcap of one with."""
    here = tmp_path_factory.mktemp("import")
    for name, left_out in (("whole", ()), ("holes", LOST)):
        log_of_a_run(here / f"{name}.csv", *left_out)
        import_log(here / f"{name}.csv", EXAMPLE, here / f"{name}.mcap")
    return here


def good(folder: Path, *words: str) -> str:
    done = hydrotwin_here(*words, cwd=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_twin_under_the_recorded_commands_gives_what_was_measured(folder):
    """The same plant: what remains is the printing. A command one row late would be seen sixtyfold."""
    close = ("position=1 um", "p2=2 kPa", "p3=2 kPa", "p_p=2 kPa")
    limits = [word for text in close for word in ("--tolerance", f"*.{text}")]
    out = good(folder, "replay", "whole.mcap", "--into", "plant", "--alone", "--output", "into.mcap", *limits)
    assert out.count("within") + out.count("same") >= 4
    assert "p1" not in out  # there was no such sensor
    (folder / "late.toml").write_text(EXAMPLE.read_text().replace("scale = 0.1", 'scale = 0.1\ndelay = "-1 ms"'))
    import_log(folder / "whole.csv", folder / "late.toml", folder / "late.mcap")
    late = hydrotwin_here(
        *("replay", "late.mcap", "--into", "plant", "--alone", "--output", "late-into.mcap", "--json"), cwd=folder
    )
    signals = {entry["signal"]: entry for entry in json.loads(late.stdout)["signals"]}
    assert signals["measurement.position"]["greatest"] > 50e-6


def test_holes_are_nothing_to_compare_with(folder):
    out = hydrotwin_here(
        *("replay", "holes.mcap", "--into", "plant", "--alone", "--output", "holes-into.mcap", "--json"), cwd=folder
    )
    signals = {entry["signal"]: entry for entry in json.loads(out.stdout)["signals"]}
    assert signals["measurement.position"]["instants"] == 1201 - len(HELD) - len(LOST)
    assert signals["measurement.p2"]["instants"] == 1201 - len(LOST)
    assert np.isfinite(signals["measurement.position"]["rms"])
    residual = read(folder / "holes-into.mcap").columns("residual")
    assert np.isnan(residual["position"][550])
    assert np.isfinite(residual["position"][450])


def test_info_says_what_it_is_and_what_is_missing(folder):
    out = good(folder, "info", "holes.mcap")
    assert "measured on a rig: no true state; imported from holes.csv by foreign-rig.toml" in out
    assert "0.7 to 0.899 s" in out
    assert re.search(r"sha256 +[0-9a-f]{64}", out)
    assert re.search(r"position +position_mm +mm +linear +0\.0423 mm", out)
    told = json.loads(good(folder, "info", "holes.mcap", "--json"))
    assert (told["mode"], told["problems"]) == ("measured", [])
    assert told["metadata"]["imported"]["signals"]["position"]["missing"] == len(HELD) + len(LOST)


def test_report_alone_and_beside_the_twin(folder):
    good(folder, "report", "holes.mcap", "-o", "a.html")
    page = (folder / "a.html").read_text(encoding="utf-8")
    assert "measured on a rig, imported from holes.csv" in page
    assert "Pressure over length and time" not in page  # nobody measured along the pipes
    good(folder, "report", "whole.mcap", "into.mcap", "-o", "b.html")
    both = (folder / "b.html").read_text(encoding="utf-8")
    assert "of whole.mcap into the plant" in both
    assert "inf mm" not in both


def test_other_verbs(folder):
    """Each takes a measured recording as any other."""
    assert good(folder, "compare", "whole.mcap", "whole.mcap").count("same") == 6
    with_twin = hydrotwin_here("compare", "whole.mcap", "into.mcap", "--json", cwd=folder)
    assert {entry["signal"] for entry in json.loads(with_twin.stdout)["signals"]} == {
        *(f"measurement.{name}" for name in ("position", "p2", "p3")),
        "channels.p_p",
    }
    good(folder, "digest", "whole.mcap", "whole.mcap")
    good(folder, "export", "holes.mcap", "--csv", "-o", "csv")
    assert "nan" in (folder / "csv" / "measurement.csv").read_text(encoding="utf-8")
    good(folder, "recover", "holes.mcap", "-o", "again.mcap")
    assert is_measured(read(folder / "again.mcap"))
    law = ("--set", "controller.kind=pd", "--set", "controller.gain=10 1/m", "--set", "controller.velocity=backward")
    into = hydrotwin_here(
        *("replay", "whole.mcap", "--into", "controller", "--alone", "--output", "c.mcap", *law), cwd=folder
    )
    assert into.returncode == 1, into.stderr  # another law: it differs, and that is told


def test_in_python(folder):
    run = hydrotwin.read(folder / "holes.mcap")
    assert run.passed
    assert run.metrics.peak_p_lower == np.nanmax(run.columns("measurement")["p2"])
    assert np.isnan(run.signal("position").value[550])
    state = seen(run.recording)
    assert np.isnan(state["flow_1"]).all()
    assert len(judged(run.recording)["stamp"]) == 1201 - len(HELD) - len(LOST)


def test_bands_may_be_stated_of_a_log(folder):
    """[scenario] expect judges what was measured."""
    own = EXAMPLE.read_text() + '\n[scenario]\nexpect = ["peak p_lower <= 100 bar", "peak p_upper <= 1 bar"]\n'
    (folder / "bands.toml").write_text(own)
    import_log(folder / "whole.csv", folder / "bands.toml", folder / "bands.mcap")
    assert [band.passed for band in hydrotwin.read(folder / "bands.mcap").bands] == [True, False]


def test_a_drive_of_the_users_own_lies_beside_the_map(folder):
    (folder / "mine.toml").write_text('extends = "ehla"\n[rig.load]\nmass = "321 kg"\n')
    (folder / "own.toml").write_text(EXAMPLE.read_text().replace('"ehla"', '"mine.toml"'))
    made = import_log(folder / "whole.csv", folder / "own.toml", folder / "own.mcap")
    assert made.scenario.rig.load.mass == 321.0
    assert facts(made.recording)["mapped"]["rig"] == "mine.toml"


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("[signal.p_p]", "[signal.p_pp]", "signal.p_pp is not a signal of this drive; did you mean 'p_p'?"),
        ("[signal.p_p]", "[signal.bladder]", "[extra.bladder]"),
        ('rig = "ehla"', 'rig = "elha"', "no such scenario or file; did you mean 'ehla'"),
        ("scale = 0.1", "scale = 0", "scale 0"),
        ('unit = "V"', 'unit = "Volt per m"', "unit 'Volt per m' is unknown"),
        ("bits = 12", "bit = 12", "signal.position.bit: unknown key"),
        ('period = "1 ms"', 'period = "1.03 ms"', "nearest: 0.001 or 0.00105 s"),
        ('["0 mm", "300 mm"]', '["0 bar", "300 mm"]', "'0 bar' is not a number in m"),
        ('method = "previous"', 'method = "spline"', "'spline' is unknown"),
        ('"0.5 LSB"', '"0.5 kg"', "'0.5 kg' is not a number in m"),
    ],
)
def test_mistakes_in_a_map_are_told_in_one_line(folder, before, after, words):
    assert before in EXAMPLE.read_text()
    (folder / "wrong.toml").write_text(EXAMPLE.read_text().replace(before, after, 1))
    done = hydrotwin_here("import", "whole.csv", "--map", "wrong.toml", "-o", "wrong.mcap", cwd=folder)
    assert done.returncode == 2
    assert words in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (folder / "wrong.mcap").exists()


def test_a_recording_that_was_imported_is_replaced_and_no_other(folder, tmp_path):
    words = ("import", str(folder / "whole.csv"), "--map", str(EXAMPLE), "-o")
    assert "in place of an earlier import" not in good(tmp_path, *words, "a.mcap")
    assert "a.mcap, in place of an earlier import" in good(tmp_path, *words, "a.mcap")
    (tmp_path / "run.mcap").write_bytes(STEP.read_bytes())
    (tmp_path / "notes.mcap").write_text("mine")
    for name, why in (
        ("run.mcap", "is there and was not written by hydrotwin import"),
        ("notes.mcap", "is there and was not written by hydrotwin import"),
        ("a.csv", "a recording is an MCAP file"),
        ("notes.mcap/a.mcap", "notes.mcap/a.mcap: Not a directory; name another file with --output"),
    ):
        done = hydrotwin_here(*words, name, cwd=tmp_path)
        assert done.returncode == 2
        assert why in done.stderr
        assert done.stderr.count("\n") == 1
    assert (tmp_path / "run.mcap").read_bytes() == STEP.read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.mcap", "notes.mcap", "run.mcap"]


INTERRUPTED = """
import os, signal, sys
from bridge.cli import main
from bridge.recording import made_before
def killed(recording, path, rig_name):
    path.write_bytes(b"half")
    os.kill(os.getpid(), signal.SIGINT)
made_before.save = killed
sys.argv = ["hydrotwin", *sys.argv[1:]]
main()
"""


def test_an_interrupted_import_says_so_and_leaves_what_was_there(folder, tmp_path):
    """Ctrl-C while the recording is written, over an earlier one."""
    shutil.copy(folder / "whole.mcap", tmp_path / "a.mcap")
    words = ("import", str(folder / "whole.csv"), "--map", str(EXAMPLE), "-o", "a.mcap")
    command = [sys.executable, "-c", INTERRUPTED, *words]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, env=ENVIRONMENT)
    assert done.returncode == -signal.SIGINT
    assert done.stderr == "hydrotwin: interrupted; a.mcap is not written, it is as it was before\n"
    assert [path.name for path in tmp_path.iterdir()] == ["a.mcap"]
    assert (tmp_path / "a.mcap").read_bytes() == (folder / "whole.mcap").read_bytes()


def test_without_a_map_or_a_log(folder):
    assert "--guess proposes" in hydrotwin_here("import", "whole.csv", cwd=folder).stderr
    assert "none.csv" in hydrotwin_here("import", "none.csv", "--map", "own.toml", cwd=folder).stderr
    assert load_map(EXAMPLE).rig == "ehla"
