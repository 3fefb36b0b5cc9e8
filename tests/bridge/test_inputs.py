"""What people write and mean: units, tables, files and numbers as they come, read or answered in one line."""

import json
import math
from pathlib import Path

import pytest
from mcap.writer import Writer
from typer.testing import CliRunner, Result

from bridge.cli.verbs import app
from bridge.errors import ScenarioError, UsageError
from bridge.replay.player import Player
from bridge.replay.timeline import Timeline
from bridge.scenario import load
from bridge.scenario.describe import warnings
from bridge.scenario.units import quantity
from controller.reference import evaluate, table_from_csv
from twin.oil import kinematic_viscosity


def hydrotwin(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments))


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("5 \u00b5s", "s", 5e-6),
        ("5 \u03bcs", "s", 5e-6),
        ("25 \u00b0C", "degC", 25.0),
        ("25\u2103", "degC", 25.0),
        ("200 cm\u00b3", "m^3", 2e-4),
        ("40 mm\u00b2/s", "m^2/s", 4e-5),
        ("30 L/min", "m^3/s", 5e-4),
        ("\u22122\u00a0mm", "m", -2e-3),
    ],
)
def test_units_are_read_as_keyboards_give_them(text: str, unit: str, value: float):
    assert quantity(text, unit) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    "text", ["0;0,1\n0,5;0,16\n", "time_s;position_m\n0;0,1\n0,5;0,16\n", "0\t0.1\n0.5\t0.16\n", "0,0.1\n0.5,0.16\n"]
)
def test_tables_are_read_as_spreadsheets_write_them(text: str):
    assert table_from_csv(text) == table_from_csv("time_s,position_m\n0,0.1\n0.5,0.16\n")


def test_a_table_that_the_command_line_names_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("ref.csv").write_text("0,0.1\n0.5,0.16\n")
    scenario = load("step", ["reference={kind='table', csv='ref.csv'}"])
    assert evaluate(scenario.reference.reference(), 0.25).position == pytest.approx(0.13)
    with pytest.raises(ScenarioError, match=r"no file 'other\.csv'"):
        load("step", ["reference={kind='table', csv='other.csv'}"])


def test_a_reference_without_its_unit_is_refused_and_one_past_the_stroke_is_warned_of():
    with pytest.raises(ScenarioError, match=r"goes to 160 m, .* from 0 to 0\.27 m; a unit may be missing"):
        load("step", ["reference.end=160"])
    assert not warnings(load("step"))
    (past,) = warnings(load("step", ["reference.end=300mm", "daq.position_range=400mm"]))
    assert "to 300 mm, the stroke from 0 to 270 mm" in past
    (short,) = warnings(load("step", ["daq.position_range=120mm"]))
    assert "daq.position_range 120 mm" in short


def test_a_scenario_that_extends_itself_is_named_however_it_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("d").mkdir()
    Path("d/own.toml").write_text('extends = "../d/own.toml"')
    Path("d/one.toml").write_text('extends = "two.toml"')
    Path("d/two.toml").write_text('extends = "../d/./one.toml"')
    with pytest.raises(ScenarioError, match=r"extends itself$"):
        load("d/own.toml")
    with pytest.raises(ScenarioError, match=r"extends itself, by way of two\.toml$"):
        load("d/one.toml")


@pytest.mark.parametrize(
    ("text", "words"), [("[]", "holds a list"), ("3", "holds a number"), ("null", "holds a value")]
)
def test_a_json_file_that_is_not_a_scenario_is_one_line(tmp_path: Path, text: str, words: str):
    (tmp_path / "own.json").write_text(text)
    with pytest.raises(ScenarioError, match=words):
        load(str(tmp_path / "own.json"))


@pytest.mark.parametrize("temperature", [-273.15, -20.1, 80.1, math.nan])
def test_oil_outside_the_data_of_its_law_is_refused(temperature: float):
    with pytest.raises(ValueError, match="holds from -20 to 80 deg C"):
        kinematic_viscosity(temperature)


def test_a_seat_without_a_drop_is_one_line():
    for kind in ("conical", "chamfered"):
        assert "nothing flows" in str(hydrotwin("valve", "seat", kind, "--drop", "0").exception)


@pytest.mark.parametrize("patience", ["nan", "inf", "-1"])
@pytest.mark.parametrize("verb", [("record",), ("plant",), ("controller",), ("run", "step"), ("view",)])
def test_a_patience_that_is_not_a_time_is_refused(verb: tuple[str, ...], patience: str):
    result = hydrotwin(*verb, f"--patience={patience}")
    assert isinstance(result.exception, UsageError)
    assert "seconds, from 0 to" in str(result.exception)


def test_a_replay_skips_back_and_stays_where_it_is_for_times_that_are_none():
    timeline = Timeline([0, 10**9, 2 * 10**9], 0)
    timeline.pause(0)
    player = Player(timeline, lambda _: None, now=lambda: 0)
    answers = {}
    for verb, value in (("seek", "1.5 s"), ("seek", "inf"), ("skip", "nan"), ("skip", "-1"), ("faster", "nan")):
        answer = player.ask(verb, value)
        player.ask("quit")
        player.run()
        answers[verb, value] = answer.result(0)
        player = Player(player.timeline, lambda _: None, now=lambda: 0)
    assert [answers[key]["time"] for key in answers] == [1.5, 1.5, 1.5, 0.5, 0.5]
    assert ["error" in answers[key] for key in answers] == [False, True, True, False, True]


def test_a_replay_that_has_ended_answers_all_the_same():
    """Whether it was asked before its end and not heeded any more, or after it."""
    player = Player(Timeline([0], 0), lambda _: None, now=lambda: 0)
    before = player.ask("status")
    player.close()
    after = player.ask("status")
    assert before.result(0) == after.result(0) == {"error": "the replay has ended"}


def test_a_negative_number_is_an_argument_of_remote(monkeypatch: pytest.MonkeyPatch):
    asked = []
    monkeypatch.setattr("bridge.replay.remote.ask", lambda _, verb, value: asked.append((verb, value)) or {})
    monkeypatch.setattr("bridge.wire.bus.Bus.__enter__", lambda self: self)
    monkeypatch.setattr("bridge.wire.bus.Bus.__exit__", lambda *_: None)
    monkeypatch.setattr("bridge.wire.bus.Bus.__init__", lambda *_, **__: None)
    assert hydrotwin("remote", "skip", "-1").exit_code == 0
    assert asked == [("skip", "-1")]


@pytest.mark.parametrize("topic", ["/battery/state", "/machine/event", "/arm/command"])
def test_topics_of_others_that_end_as_ours_do_are_left_alone(tmp_path: Path, topic: str):
    file = tmp_path / "b.mcap"
    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        channel = writer.register_channel(topic, "json", writer.register_schema("T", "jsonschema", b"{}"))
        for i in range(5):
            writer.add_message(channel, i * 10**7, b"{}", i * 10**7, i)
        writer.finish()
    found = hydrotwin("info", str(file), "--json")
    assert found.exit_code == 0, found.output
    assert [channel["topic"] for channel in json.loads(found.stdout)["channels"]] == [topic]
    for verb in (("export", str(file), "--csv"), ("view", str(file), "--save", str(tmp_path / "b.rrd"))):
        error = hydrotwin(*verb).exception
        assert error is None or isinstance(error, UsageError | SystemExit), error
