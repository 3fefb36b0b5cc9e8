"""The Rerun view: the file holds what the recording holds, the page answers and ends, mistakes get one line."""

import re
import signal
import struct
import subprocess
import sys
import urllib.request
from pathlib import Path

import numpy as np
import pytest

from bridge.errors import UsageError
from bridge.recording.reader import Recording, read
from bridge.runs.in_process import record_in_process
from bridge.runs.picture import draw as picture
from bridge.scenario import load
from bridge.view.curves import CURVES, PICTURES, Drawn, samples, span
from bridge.view.show import show

ROOT = Path(__file__).parents[2]
TICKS = 601  # 0.6 s at 1 kHz, with the first
SAMPLES = 61  # at 10 ms
UNITS = {  # of what a picture shows, in SI
    "position_mm": 1e-3,
    "pressure_bar": 1e5,
    "valve": 1.0,
    "flow_l_min": 1e-3 / 60.0,
    "relief_um": 1e-6,
    "cavity_cm3": 1e-6,
    "measured_bar": 1e5,
    "places_bar": 1e5,
}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short recording, made without middleware."""
    from bridge.processes.options import RunOptions
    from bridge.runs.run import run_scenario
    from bridge.wire.messages import Mode

    path = tmp_path_factory.mktemp("view") / "short.mcap"
    run_scenario(load("step", ["duration=0.6 s"]), RunOptions(Mode.INPROCESS, path))
    return path


def column(file: Path, entity: str, component: str) -> tuple[list[int], list]:
    """Stamps [ns] and values of one component of an entity, read by Rerun's own reader."""
    from rerun.chunk import RrdReader

    chunks = [c for c in RrdReader(file).stream() if c.entity_path == entity and not c.is_static]
    batches = [chunk.to_record_batch() for chunk in chunks]
    stamps = np.concatenate([batch.column("sim_time").cast("int64").to_numpy() for batch in batches])
    values = [row[0] for batch in batches for row in batch.column(component).to_pylist()]
    return stamps.tolist(), values


@pytest.fixture(scope="module")
def view(recorded: Path) -> Path:
    pytest.importorskip("rerun")
    path = recorded.with_suffix(".rrd")
    show(recorded, web=False, save=path)
    return path


@pytest.mark.parametrize("curve", [c for c in CURVES if c.topic != "timing"], ids=lambda c: c.entity)
def test_every_curve_is_the_recording_in_the_unit_it_names(view: Path, recorded: Path, curve):
    stamps, values = column(view, f"/{curve.entity}", "Scalars:scalars")
    columns = read(recorded).columns(curve.topic)
    assert len(stamps) == (SAMPLES if curve.topic == "reference" else TICKS)
    assert stamps == columns["stamp"].tolist()
    unit = UNITS[curve.picture]
    assert np.array(values) * unit == pytest.approx(columns[curve.field], rel=1e-12)


def test_every_picture_names_its_unit():
    assert all(("[" in title and title.endswith("]")) or "[bar]" in title for title in PICTURES.values())


def test_piston_starts_at_a_hundred_millimetres(view: Path):
    assert column(view, "/position_mm/piston", "Scalars:scalars")[1][0] == pytest.approx(100.0)


def test_events_stand_at_their_simulated_time(view: Path):
    stamps, text = column(view, "/events", "TextLog:text")
    assert stamps == [0, 600_000_000]
    assert [line.partition(" s  ")[2].partition(":")[0] for line in text] == ["started", "ended"]


def test_a_change_is_a_mark_on_the_piston_s_curve_where_it_begins(tmp_path: Path):
    """At 0.2 s, and 0.1 s after the piston has passed 105 mm; the log says what it was, and when it was told."""
    pytest.importorskip("rerun")
    push = '{set="rig.load.force", at="0.2 s", to="100 N"}'
    late = '{set="controller.gain", when="position > 105 mm", after="0.1 s", to="0.5 V/%"}'
    changes = ["duration=0.6 s", "reference.at=0.1", f"timeline=[{push}, {late}]"]
    recorded = record_in_process(load("step", changes), tmp_path / "a.mcap")
    show(recorded.path, web=False, save=tmp_path / "a.rrd")
    stamps, values = column(tmp_path / "a.rrd", "/position_mm/change", "Scalars:scalars")
    state = recorded.columns("state")
    passed = int(state["stamp"][np.argmax(state["position"] > 0.105)])
    assert sorted(stamps) == sorted([200_000_000, passed + 100_000_000])
    at = np.searchsorted(state["stamp"], stamps)
    assert values == pytest.approx(1e3 * state["position"][at])
    told = [event for event in recorded.messages("event") if event.command == 2]
    assert [event.stamp for event in told] == [passed]
    assert told[0].text.endswith(f", from {(passed + 100_000_000) / 1e9:g} s on")


def test_file_carries_its_layout_and_verifies(view: Path):
    command = [sys.executable, "-m", "rerun_cli", "rrd"]
    subprocess.run([*command, "verify", str(view)], check=True, timeout=60, capture_output=True)
    stats = subprocess.run([*command, "stats", str(view)], check=True, timeout=60, capture_output=True, text=True)
    axes = set(re.findall(r"^/view/[^/]*/TimeAxis:", stats.stdout, re.MULTILINE))
    assert len(axes) == len(PICTURES) - 1  # no wall time in process


def test_wall_time_is_shown_in_microseconds_and_only_where_measured():
    lateness, trip = (curve for curve in CURVES if curve.topic == "timing")
    numbers = {"stamp": [1, 2, 3], "lateness": [0, 70_000, 10], "round_trip": [-1, 250_000, -1]}
    columns = {name: np.array(values) for name, values in numbers.items()}
    assert samples(lateness, columns)[1].tolist() == pytest.approx([0.0, 70.0, 0.01])
    assert [part.tolist() for part in samples(trip, columns)] == [[2], [250.0]]


def test_axis_holds_the_curves_and_no_constant_is_squeezed():
    def drawn(*values: float) -> Drawn:
        return Drawn(CURVES[0], np.arange(len(values)), np.array(values))

    low, high = span([drawn(100.0, 110.0), drawn(200.0)], CURVES[0].picture)
    assert low < 100.0 < 200.0 < high
    low, high = span([drawn(5.0, 5.0)], CURVES[0].picture)
    assert low < 5.0 < high


def test_without_rerun_one_line_says_how_to_get_it(recorded: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("bridge.view.rerun_program.find_spec", lambda name: None)
    with pytest.raises(UsageError, match=re.escape("pip install 'hydrotwin[view]'")) as raised:
        show(recorded, web=False, save=recorded.with_name("never.rrd"))
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("content", "complaint"),
    [(None, "No such file"), (b"no recording", "not an MCAP file"), (b"\x89MCAP0\r\n", "holds no state")],
)
def test_file_without_a_run_gets_one_line(tmp_path: Path, content: bytes | None, complaint: str):
    pytest.importorskip("rerun")
    file = tmp_path / "a.mcap"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(UsageError, match=complaint) as raised:
        show(file, web=False, save=tmp_path / "a.rrd")
    assert "\n" not in str(raised.value)


def test_no_recording_is_overwritten(recorded: Path):
    pytest.importorskip("rerun")
    before = recorded.read_bytes()
    with pytest.raises(UsageError, match=r"name it .*short\.rrd"):
        show(recorded, web=False, save=recorded)
    assert recorded.read_bytes() == before


def test_a_folder_that_is_not_there_gets_one_line(recorded: Path, tmp_path: Path):
    pytest.importorskip("rerun")
    with pytest.raises(UsageError, match="cannot write"):
        show(recorded, web=False, save=tmp_path / "missing" / "a.rrd")


def test_without_a_screen_the_ways_out_are_named(recorded: Path, monkeypatch: pytest.MonkeyPatch):
    pytest.importorskip("rerun")
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(UsageError, match="--web"):
        show(recorded, web=False, save=None)


@pytest.mark.parametrize(("ending", "code"), [(signal.SIGINT, 0), (signal.SIGTERM, 0), (signal.SIGHUP, 0)])
def test_page_answers_on_loopback_and_ends_with_its_program(recorded: Path, ending: signal.Signals, code: int):
    """At Ctrl-C, when the terminal is closed, when it is killed politely."""
    pytest.importorskip("rerun")
    command = [sys.executable, "-m", "bridge", "view", str(recorded), "--web"]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout
            page = server.stdout.readline().strip()
            assert page.startswith("http://127.0.0.1:")
            with urllib.request.urlopen(page, timeout=10) as answer:
                assert answer.status == 200
                assert b"rerun" in answer.read().lower()
            server.send_signal(ending)
            assert server.wait(60) == code
        finally:
            server.kill()
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(page, timeout=2)


def test_cut_off_recording_shows_what_came_before(recorded: Path, tmp_path: Path):
    pytest.importorskip("rerun")
    whole = recorded.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: len(whole) * 2 // 3])
    kept = len(list(read(cut).of("state")))
    assert 0 < kept < TICKS
    show(cut, web=False, save=tmp_path / "cut.rrd")
    assert len(column(tmp_path / "cut.rrd", "/position_mm/piston", "Scalars:scalars")[0]) == kept


@pytest.fixture(scope="module")
def eventful(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    """The load change until the relief valve has opened and shut."""
    path = tmp_path_factory.mktemp("view") / "eventful.mcap"
    return record_in_process(load("load-change", ["duration=1.2 s"]), path)


@pytest.mark.parametrize(("length", "happening"), [(0.9, False), (1.2, True)])
def test_the_picture_of_a_run_has_further_rows_only_where_something_happened(
    length: float, happening: bool, eventful: Recording, tmp_path: Path
):
    """Three rows of 2.4 inch at 120 dots; relief valve and vapour add theirs."""
    recording = eventful if happening else record_in_process(load("step", [f"duration={length}"]), tmp_path / "a.mcap")
    height = struct.unpack(">I", picture(recording, recording.scenario(), tmp_path / "a.png").read_bytes()[20:24])[0]
    assert (height > 3 * 2.4 * 120 + 1) == happening
