"""What of a recording a fit is made from: holes, ranges and noise of logs, commands that did not act; what is said."""

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bridge.cli import tables
from bridge.cli.sweep import continuation
from bridge.errors import UsageError
from bridge.loop.exchange import exchange, sides
from bridge.recording.logs.importing import import_log, imported
from bridge.recording.logs.map import parsed_map
from bridge.recording.logs.measured import measured
from bridge.recording.reader import Recording
from bridge.recording.writer import entries_of, save
from bridge.report.identification import _drawn
from bridge.runs.in_process import in_memory_recording, run_in_memory
from bridge.scenario import load
from bridge.scenario.circuit import in_memory
from bridge.studies.identification.data import Record, with_noise
from bridge.studies.identification.identify import deviations_of, scenario_of
from bridge.studies.identification.imported import imported_record
from bridge.studies.identification.parameters import parameters_of
from bridge.studies.identification.recorded import record_in
from bridge.studies.identification.simulation import Shot, Simulation, shots_of
from bridge.studies.identification.whiteness import ljung_box
from bridge.wire.messages import EventKind, Outgoing
from tests.support.command import hydrotwin_here
from tests.support.logs import MAP

ROWS = 1500
TIME = 1e-3 * np.arange(ROWS)  # [s]
RNG = np.random.default_rng(5)
MM = 135.0 + 20.0 * np.sin(2.0 * math.pi * 3.0 * TIME) + 0.01 * RNG.standard_normal(ROWS)
BAR = 300.0 + 15.0 * np.cos(2.0 * math.pi * 3.0 * TIME) + 0.02 * RNG.standard_normal(ROWS)
COLUMNS = MAP.format(u="u", x="x", p="p", time='[time]\ncolumn = "t"\nunit = "s"')


def log_at(path: Path, x: np.ndarray = MM, p: np.ndarray = BAR, step: float = 1e-3) -> Path:
    """A log with holes where the arrays have them."""
    cells = [["" if math.isnan(value) else f"{value:.6f}" for value in column] for column in (x, p)]
    rows = (f"{step * k:.6f},{2.5 * (k >= 100)},{a},{b}" for k, (a, b) in enumerate(zip(*cells, strict=True)))
    path.write_text("\n".join(["t,u,x,p", *rows]))
    return path


def record_of_log(folder: Path, x: np.ndarray = MM, p: np.ndarray = BAR, sensor: str = "") -> Record:
    """Of a log of 1 kHz; sensor: what its map says besides of the pressure p2, its last table."""
    path = log_at(folder / "log.csv", x, p)
    return imported_record(imported(path, parsed_map(COLUMNS + sensor, "map"), folder / "map.toml").recording, "log")


@pytest.mark.parametrize(
    ("sensor", "compared"),
    [("", ROWS), ('range = ["0 bar", "400 bar"]', ROWS), ('range = ["0 bar", "310 bar"]\nbits = 12', None)],
)
def test_samples_are_left_out_at_the_ends_that_the_map_states_and_at_no_others(tmp_path, sensor, compared):
    """Without a range nothing is, and that of the built-in card, 250 bar, says nothing of a log."""
    record = record_of_log(tmp_path, sensor=sensor)
    p2 = record.signal("p2")
    assert p2 is not None
    if compared:
        assert p2.counted.sum() == compared
        assert not record.told
    else:
        assert not p2.counted[BAR > 310.0].any()
        assert p2.counted[BAR < 305.0].all()
        assert record.told[0].startswith(f"{p2.counted.sum()} of {ROWS} samples of p2 are compared")


def test_shots_begin_where_the_position_is_known(tmp_path):
    """Holes at the start and across the beginnings of shots; a shot whose hole goes to its end is left out."""
    holes = np.where((np.arange(ROWS) < 40) | ((np.arange(ROWS) > 350) & (np.arange(ROWS) < 700)), np.nan, MM)
    record = record_of_log(tmp_path, holes)
    assert record.samples == ROWS - 40
    assert record.told[0] == "from 0.04 s, where command and position are both known"
    whole, cut = shots_of([record_of_log(tmp_path)], 0.2), shots_of([record], 0.2)
    assert [shot.begin - shot.warm for shot in cut] == [120] * len(cut)
    assert 0 < len(cut) < len(whole)
    signal = record.signal("position")
    assert signal is not None
    assert all(np.isfinite(signal.value[max(0, s.warm - 5) : s.warm + 6]).sum() >= 3 for s in cut)
    (moved,) = (shot for shot in cut if 310 < shot.warm < 680)
    with in_memory():
        scenario = load("ehla")
        state = Simulation(scenario.rig_values(), scenario.loop.step).warm(record, moved)
    assert np.isfinite(state).all()


def test_where_no_shot_can_begin_a_fit_is_refused_in_one_sentence(tmp_path):
    record = record_of_log(tmp_path)
    signals = tuple(
        s._replace(value=np.where(np.arange(ROWS) % 6, np.nan, s.value)) if s.name == "position" else s
        for s in record.signals
    )
    with pytest.raises(UsageError, match="no stretch begins where the position is known; a fit needs 3 samples"):
        shots_of([record._replace(signals=signals)], 1.0)


def test_a_second_is_the_least_that_a_fit_takes_at_any_rate(tmp_path):
    path = log_at(tmp_path / "log.csv", MM, BAR, 1e-4)
    made = imported(path, parsed_map(COLUMNS.replace('"1 ms"', '"0.1 ms"'), "map"), tmp_path / "map.toml")
    with pytest.raises(UsageError, match=r"1500 samples .* a fit needs 10000, which are 1 s"):
        imported_record(made.recording, "log")


def test_signals_that_say_nothing_are_left_out_and_that_is_said(tmp_path):
    record = record_of_log(tmp_path, p=np.full(ROWS, 60.0))
    assert [signal.name for signal in record.signals] == ["position"]
    assert record.told == ["p2 never changes, and says nothing; it is left out"]
    few = record_of_log(tmp_path, p=np.where(np.arange(ROWS) < 150, np.round(BAR / 20.0) * 20.0, np.nan))
    assert [signal.name for signal in few.signals] == ["position"]
    assert "to estimate its noise takes 200" in few.told[0]
    with pytest.raises(UsageError, match="position never changes, and says nothing; a fit needs a rod that moves"):
        record_of_log(tmp_path, np.full(ROWS, 135.0))


def test_a_signal_without_noise_counts_as_one_with_a_little(tmp_path):
    """1e-4 of a span of 30 bar; --noise takes the place of that and of what is said of it."""
    record = record_of_log(tmp_path, p=300.0 + 15.0 * np.cos(2.0 * math.pi * 0.2 * TIME))
    span = 1e5 * 15.0 * (1.0 - math.cos(2.0 * math.pi * 0.3))
    p2 = record.signal("p2")
    assert p2 is not None
    assert p2.deviation == pytest.approx(1e-4 * span, rel=1e-3)
    assert "--noise says better" in record.told[0]
    other = with_noise(record, deviations_of([("p2", "0.05 bar")], record, "log.mcap"))
    assert other.told == []
    assert [s.deviation for s in other.signals if s.name == "p2"] == [5e3]


def test_a_noise_is_read_in_the_unit_of_its_signal(tmp_path):
    record = record_of_log(tmp_path)
    assert deviations_of([("p2", "0.05")], record, "a")["p2"] == (
        0.05,
        "p2 has a noise of 0.05 Pa: --noise names no unit",
    )
    for text, words in (("0.05 mm", r"valid: Pa, kPa, MPa, GPa, bar"), ("-1 bar", "must be above 0")):
        with pytest.raises(UsageError, match=words):
            deviations_of([("p2", text)], record, "a")
    with pytest.raises(UsageError, match="--noise p9: a has position, p2"):
        deviations_of([("p9", "1")], record, "a")


@pytest.mark.parametrize("share", [1.0, 0.25, 0.1])
def test_white_noise_is_noise_however_many_samples_are_compared(share):
    """Of 400 draws 5 % have a probability below 5 %: 20 +- 4.4. Counting all samples it is most of them."""
    rng, below = np.random.default_rng(4), 0
    for _ in range(400):
        mask = rng.random(3000) < share
        below += ljung_box([rng.standard_normal(3000) * mask], [mask])[1] < 0.05
    assert 5 < below < 40


def test_what_is_too_long_to_list_is_not_listed_and_limits_are_not_cut():
    for name, meant in (
        ("rig.load.masss", "did you mean rig.load.mass?"),
        ("controller.gain", "hydrotwin describe"),
        ("rig.pump.displacement", "rig.fixed_pump.displacement"),
    ):
        with pytest.raises(UsageError) as refused:
            parameters_of([name], load("ehla"))
        assert meant in str(refused.value)
        assert len(str(refused.value)) < 200
    with pytest.raises(UsageError, match="is too low: the least that a scenario takes is 1e-12 kg"):
        parameters_of(["rig.load.mass=-5:400kg"], load("ehla"))


def test_a_log_has_the_rig_of_its_map_and_what_is_refused_leaves_nothing(tmp_path):
    """Its own name, that of the log, is not a scenario's; a file that the map names has to be named again."""
    (tmp_path / "map.toml").write_text(COLUMNS)
    import_log(log_at(tmp_path / "nom6.csv"), tmp_path / "map.toml", tmp_path / "nom6.mcap")
    scenario, extends = scenario_of(None, ["rig.load.mass=210 kg"], [str(tmp_path / "nom6.mcap")])
    assert (scenario.name, extends, scenario.rig.load.mass) == ("nom6", "ehla", 210.0)
    done = hydrotwin_here(
        "identify", "nom6.mcap", "--fit", "rig.load.mass", "--noise", "p2=1 mm", "--workers", "1", cwd=tmp_path
    )
    assert done.returncode == 2
    assert "--noise p2='1 mm': unit 'mm' does not fit here" in done.stderr
    assert not list(tmp_path.glob("runs/*"))
    (tmp_path / "own.toml").write_text('extends = "ehla"')
    (tmp_path / "map.toml").write_text(COLUMNS.replace('"ehla"', '"own.toml"'))
    import_log(tmp_path / "nom6.csv", tmp_path / "map.toml", tmp_path / "own.mcap")
    with pytest.raises(UsageError, match=r"of the rig 'own.toml', which is not built in: name its file with --rig"):
        scenario_of(None, [], [str(tmp_path / "own.mcap")])


def test_changes_are_made_to_the_recorded_rig_and_not_to_the_built_in_one_of_its_name(tmp_path):
    with in_memory():
        run = run_in_memory(load("ehla", ["duration=10 ms", "rig.oil.bulk_modulus=9000 bar"]))
    path = save(run, tmp_path / "run.mcap", "rig")
    scenario, extends = scenario_of(None, ["rig.load.mass=50 kg"], [str(path)])
    assert (scenario.rig.load.mass, scenario.rig.oil.bulk_modulus, extends) == (50.0, 9e8, "ehla")


def intruded(since: float, missed: float) -> Recording:
    """1.5 s of a loop in which a second source sends, too, from a time on, and one command never arrives [s]."""
    scenario = load("ehla", ["duration=1.5 s", "controller.gain=10 1/m"])
    plant, controller = sides(scenario)
    take, entries = plant.take, []
    plant.take = lambda command: command.sample_stamp == round(missed * 1e9) or take(command)
    for messages in exchange(plant, controller, scenario.ticks):
        sent = [m.message for m in messages if m.topic == "command" and m.message.sample_stamp >= since * 1e9]
        others = [_by_another(one) for one in sent]
        for other in others:
            assert not take(other)
        entries += entries_of([*messages, *(Outgoing("command", o.sample_stamp, o.sequence, o) for o in others)])
    return in_memory_recording(scenario, entries, plant.run_id, plant.status())


def _by_another(command: Any) -> Any:
    fields = {name: getattr(command, name) for name in command.__dataclass_fields__ if name != "__msgtype__"}
    return type(command)(**{**fields, "source": command.source + 1, "spool": 1.0})


def test_neither_commands_that_were_refused_nor_one_that_was_missed_count_as_acting():
    """Of 100 refusals each is told, then they are only counted: from there on nobody knows which command acts."""
    with in_memory():
        alone, run = intruded(9.0, 0.8), intruded(1.2, 0.8)
    end = next(e.stamp for e in run.messages("event") if e.kind == EventKind.REFUSED and "only counted" in e.text)
    assert 1.25e9 < end < 1.35e9
    true, found = measured(alone), measured(run)
    before = found.times < end / 1e9
    assert np.array_equal(found.command[before], true.command[before])
    assert np.isnan(found.command[~before]).all()
    missed = next(c for c in alone.messages("command") if c.sample_stamp == 800_000_000)
    at = int(np.argmin(np.abs(true.times - missed.apply_at / 1e9)))  # where it would have acted
    assert true.command[at] == true.command[at - 1] != true.command[at + 1]
    record = record_in(run)
    assert record.duration == pytest.approx(end / 1e9, abs=3e-3)
    assert "it is no longer told which commands were refused" in record.told[0]
    assert np.abs(record.stretches.reference).max() < 1.0


def test_the_page_draws_nothing_where_nothing_is_compared(tmp_path):
    record = record_of_log(tmp_path, p=np.where((np.arange(ROWS) > 500) & (np.arange(ROWS) < 800), np.nan, BAR))
    shot, count = Shot(0, 0, 300, ROWS - 1), ROWS - 301
    at = SimpleNamespace(reading=np.ones((2, count)), residual=np.zeros(2 * count))
    found: Any = SimpleNamespace(task=SimpleNamespace(records=[record], shots=[shot]), shots=[at])
    measured_p2, left = (axis.lines[0] for axis in _drawn(found, 0).axes[2:4])
    for curve in (measured_p2, left):
        time, value = (np.asarray(part) for part in curve.get_data())
        assert np.isnan(value[(time > 0.51) & (time < 0.79)]).all()
        assert np.isfinite(value[time < 0.48]).all()


def test_names_stay_whole_in_a_narrow_window(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """In one of 80 columns the lines keep to it; in one of 50 they go beyond it."""
    names = ["rig.cylinder.leakage_resistance", "rig.servo_valve.natural_frequency"]
    heads = ("number", "at first", "95 % interval", "times the noise at first")
    rows = [(name, "100 bar/(l/min)", "83.27 bar/(l/min) .. 83.33 bar/(l/min)", "1.23") for name in names]
    for width in (80, 50):
        monkeypatch.setattr(tables, "UNFOLDED", width)
        tables.print_table(heads, rows)
        out = capsys.readouterr().out
        assert set(out.split()) == {word for row in (heads, *rows) for cell in row for word in cell.split()}
        assert max(map(len, out.splitlines())) <= max(width, 80)


def test_an_interrupted_fit_claims_to_keep_only_what_it_keeps(tmp_path: Path):
    (tmp_path / "runs").mkdir()
    assert (
        continuation(tmp_path / "runs/fitted.toml", tmp_path / "runs/fitted.part")() == "interrupted; nothing is kept"
    )
    assert not (tmp_path / "runs").exists()
    words = continuation(tmp_path / "sig.toml", tmp_path / "sig.part")
    (tmp_path / "sig.part").write_text("head\none\n")
    assert words().startswith(f"interrupted; 1 run kept in {tmp_path / 'sig.part'}; to continue: ")
