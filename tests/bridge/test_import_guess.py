"""`hydrotwin import --guess`: the proposed map is one that can be used, right but for what no log can say."""

import json
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer

from bridge.recording.logs.guess import guessed_map
from bridge.recording.logs.guessed_scale import converter_of
from bridge.recording.logs.importing import imported
from bridge.recording.logs.kinds import Sure
from bridge.recording.logs.map import load_map, parsed_map
from bridge.recording.logs.measured import measured
from bridge.recording.logs.sensors import quantum
from tests.support.command import hydrotwin_here
from tests.support.logs import BAR, MM, ROWS, TIME, VOLTS

STEP = Path(__file__).parents[2] / "recordings" / "step.mcap"
EXAMPLE = Path(__file__).parents[2] / "examples" / "import" / "foreign-rig.toml"
LSB_MM, LSB_BAR = 300.0 / 4096.0, 250.0 / 4096.0


def foreign(folder: Path, rows: int = 6000) -> Path:
    """A log with the columns, the converter and the printing of the foreign rig; the command moves the rod."""
    random, time = np.random.default_rng(4), np.arange(rows) * 1e-3
    volts = np.repeat(random.uniform(-4.0, 4.0, rows // 300), 300)
    mm = 135.0 + np.cumsum(volts - volts.mean()) * 0.02
    bars = [offset + 8.0 * np.sin(20.0 * time) for offset in (118.0, 40.0, 70.0)]

    def read(values, lsb):
        return np.round(values / lsb + random.normal(0.0, 0.5, rows)) * lsb

    columns = [time, volts, read(mm, LSB_MM), *(read(bar, LSB_BAR) for bar in bars)]
    lines = ["time_s,valve_command,position_mm,p_supply_bar,p_A_bar,p_B_bar"]
    lines += ["{:.3f},{:.3f},{:.2f},{:.2f},{:.2f},{:.2f}".format(*row) for row in zip(*columns, strict=True)]
    path = folder / "foreign.csv"
    path.write_text("\n".join(lines))
    return path


def test_the_guess_at_the_foreign_rig_is_the_example(tmp_path):
    """Signals, columns, units, scale, ranges, bits and noise: all that the example says, from the log alone."""
    path = foreign(tmp_path)
    guessed, stated = parsed_map(guessed_map(path, "ehla").text, "guess"), load_map(EXAMPLE)
    by_guess, by_hand = (measured(imported(path, one, EXAMPLE).recording) for one in (guessed, stated))
    assert by_guess.signals.keys() == by_hand.signals.keys()
    assert (by_guess.command == by_hand.command).all()
    assert by_guess.sensors == by_hand.sensors
    for name, values in by_hand.signals.items():
        assert (by_guess.signals[name] == values).all()


def test_what_is_printed_can_be_used_as_it_is(tmp_path):
    foreign(tmp_path)
    done = hydrotwin_here("import", "foreign.csv", "--guess", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    (tmp_path / "map.toml").write_text(done.stdout)
    again = hydrotwin_here("import", "foreign.csv", "--map", "map.toml", "-o", "a.mcap", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert "unsure" in done.stdout


def test_a_command_that_goes_the_other_way_gets_a_sign(tmp_path):
    path = foreign(tmp_path)
    head, *rows = path.read_text().split("\n")
    turned = [row.split(",") for row in rows]
    path.write_text("\n".join([head, *(",".join([r[0], str(-float(r[1])), *r[2:]]) for r in turned)]))
    found = parsed_map(guessed_map(path, "ehla").text, "guess")
    assert found.signal["command"].sign == -1


def test_a_german_log_with_a_counter_and_columns_of_others(tmp_path):
    """Words, units in brackets, a counter of milliseconds that begins again; what is none of ours is kept."""
    ticks = (65_400 + np.arange(ROWS)) % 65_536
    lines = ["Zeit [ms];Ventil [V];Kolbenweg [mm];Druck Kolbenseite [bar];Öltemperatur [°C];Status"]
    rows = zip(ticks, VOLTS, MM, BAR, strict=True)
    lines += [f"{n};{u:.3f};{x:.3f};{p:.3f};45,5;an".replace(".", ",") for n, u, x, p in rows]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(lines), encoding="cp1252")
    proposal = guessed_map(path, "ehla")
    found = parsed_map(proposal.text, "guess")
    assert (found.time.wrap, found.time.unit) == (65_536, "ms")
    assert {name: one.column for name, one in found.signal.items()} == {
        "command": "Ventil [V]",
        "position": "Kolbenweg [mm]",
        "p2": "Druck Kolbenseite [bar]",
    }
    assert [one.column for one in found.extra.values()] == ["Öltemperatur [°C]"]
    rows_of = measured(imported(path, found, tmp_path / "map.toml").recording)
    assert np.abs(rows_of.signals["p2"] - BAR * 1e5).max() <= 50.1  # printed to 1 mbar


def test_names_say_less_than_units(tmp_path):
    """A bare letter is likely at best, and without a unit unsure: the map says so."""
    lines = ["t,u,x,q", *(f"{t},{u / 10},{x},{1.0}" for t, u, x in zip(TIME, VOLTS, MM, strict=True))]
    (tmp_path / "log.csv").write_text("\n".join(lines))
    signals = guessed_map(tmp_path / "log.csv", "ehla").signals
    assert {name: guess.sure for name, guess in signals.items()} == {"command": Sure.UNSURE, "position": Sure.UNSURE}


def test_how_sure_a_name_is_and_why_is_printed_as_the_guide_has_it(tmp_path):
    """A word is sure with a unit and likely without, a letter likely and unsure; of the port no log says the side."""
    rows = zip(TIME, VOLTS, MM, BAR, BAR, strict=True)
    lines = ["t_s,valve,x_mm,p_A_bar,q b", *(f"{t},{u / 10},{x},{p},{q}" for t, u, x, p, q in rows)]
    (tmp_path / "log.csv").write_text("\n".join(lines))
    text = guessed_map(tmp_path / "log.csv", "ehla").text
    assert "[signal.command]  # likely: name 'valve', no unit" in text
    assert "[signal.position]  # likely: letter 'x' and unit mm" in text
    assert "[signal.p2]  # likely: letter 'a' and unit bar" in text
    assert "# p2 is the chamber of port A; unsure: a log does not say whether cap or rod side" in text


def test_a_guess_goes_to_a_file_of_its_own_and_takes_no_map(tmp_path):
    foreign(tmp_path)
    done = hydrotwin_here("import", "foreign.csv", "--guess", "-o", "map.toml", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "map.toml\n")
    assert load_map(tmp_path / "map.toml").rig == "ehla"
    for words, why in (
        (("--guess", "-o", "map.toml"), "-o map.toml: is there already"),
        (("--guess", "-o", "map.txt"), "-o map.txt: a map is a TOML file"),
        (("--guess", "--map", "map.toml"), "--guess proposes a map, and --map gives one"),
        (("--rig", "step", "--map", "map.toml"), "--rig step: is of --guess"),
    ):
        done = hydrotwin_here("import", "foreign.csv", *words, cwd=tmp_path)
        assert done.returncode == 2
        assert why in done.stderr


def test_of_a_recording_of_ours_nothing_is_guessed(tmp_path):
    done = hydrotwin_here("import", str(STEP), "--guess", cwd=tmp_path)
    assert done.returncode == 2
    assert "is a recording of hydrotwin; it needs no import" in done.stderr


def test_our_own_names_are_known_and_counters_are_not_signals(tmp_path):
    """Columns as our own exports have them: of the card before of the joint, the spool and not the command's number."""
    names = "time_s,command.sequence,command.source,command.apply_at,command.spool,joint.position,measurement.position"
    rows = zip(TIME, range(ROWS), VOLTS, MM, strict=True)
    lines = [names, *(f"{t},{n},{n % 7},{10 * n},{u / 10},{x / 1e3},{x / 1e3}" for t, n, u, x in rows)]
    (tmp_path / "log.csv").write_text("\n".join(lines))
    found = guessed_map(tmp_path / "log.csv", "ehla").signals
    assert {name: guess.column for name, guess in found.items()} == {
        "command": "command.spool",
        "position": "measurement.position",
    }


@pytest.mark.parametrize(("top", "bits", "digits"), [(300.0, 12, 2), (250.0, 12, 2), (10.0, 16, 5), (400.0, 14, 3)])
def test_a_converter_is_found_by_the_steps_between_values(top, bits, digits):
    """Also where printing has rounded each value."""
    lsb = top / 2.0**bits
    true = 0.4 * top + 0.2 * top * np.sin(np.linspace(0.0, 40.0, 60_000))
    values = np.round(np.round(true / lsb) * lsb, digits)
    assert quantum(values) == pytest.approx(lsb, rel=2e-3)
    found = converter_of(values)
    assert found is not None
    assert (found.top, found.bits) == (top, bits)


def test_what_has_no_converter_gets_none():
    assert converter_of(np.random.default_rng(5).normal(size=5000)) is None


def test_a_bag_has_times_of_its_own_and_what_stands_still_is_no_position(tmp_path):
    """Topics of JSON without units: the joint that moves, a pressure by its name, and no map of times."""
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("rig", "json", writer.register_schema("rig", "jsonschema", b"{}"))
        for k in range(ROWS):
            body = {"name": ["swing", "boom"], "position": [0.5, MM[k] / 1e3], "valve_u": VOLTS[k], "p_cap": BAR[k]}
            writer.add_message(channel, k * 10**6, json.dumps(body).encode(), k * 10**6, k)
        writer.finish()
    found = parsed_map(guessed_map(tmp_path / "a.mcap", "ehla").text, "guess")
    assert {name: (one.column, one.unit) for name, one in found.signal.items()} == {
        "position": ("rig.position[boom]", "m"),
        "command": ("rig.valve_u", "V"),
        "p2": ("rig.p_cap", "bar"),
    }
    rows = measured(imported(tmp_path / "a.mcap", found, tmp_path / "map.toml").recording)
    assert np.abs(rows.signals["p2"] - BAR * 1e5).max() < 1e-6
