"""Mistakes in a scenario file: keys in the wrong section, values of the wrong type, channels of a part taken away."""

import pytest

from bridge.scenario import ScenarioError, load

PRESS = 'extends = "press"\n'
BODIES = "[rig.accessory_a] or [rig.accessory_b]"


def said(tmp_path, text: str, changes: list[str] | None = None) -> list[str]:
    """The lines that refuse a file, without its name; none where it is taken."""
    path = tmp_path / "own.toml"
    path.write_text(text)
    try:
        load(str(path), changes)
    except ScenarioError as error:
        return [line.removeprefix(f"{path}: ") for line in str(error).splitlines()]
    return []


@pytest.mark.parametrize(
    "section", ["start", "loop", "controller", "reference", "daq", "safety", "real_time", "allowed"]
)
def test_a_section_of_its_own_under_the_rig_is_told_where_it_stands(tmp_path, section):
    own = f"rig.{section}: not a part of the rig but a section of its own; write [{section}] "
    (line,) = said(tmp_path, f"{PRESS}[rig.{section}]\nx = 1\n")
    assert line.startswith(own)
    (line,) = said(tmp_path, PRESS, [f"rig.{section}.x=1"])
    assert line.startswith(own)


@pytest.mark.parametrize("part", ["cylinder", "load", "pipe_3", "accumulator", "variable_pump", "accessory_a"])
def test_a_part_of_the_rig_at_the_top_is_told_where_it_stands(tmp_path, part):
    (line,) = said(tmp_path, f"{PRESS}[{part}]\nx = 1\n")
    assert line.startswith(f"{part}: a part of the rig; write [rig.{part}] ")


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("[loop]\nbits = 14\n", "loop.bits: does not belong here; write it under [daq]"),
        (
            "[rig.cylinder]\nmass = 3\n",
            "rig.cylinder.mass: does not belong here; write it under [rig.load] or " + BODIES,
        ),
        ("[rig.load]\nbore = 3\n", "rig.load.bore: does not belong here; write it under [rig.cylinder]"),
        ("[daq]\ngain = 3\n", "daq.gain: does not belong here; write it under [controller]"),
        ("[rig]\nbits = 3\n", "rig.bits: does not belong here; write it under [daq]"),
        ("bore = 3\n", "bore: does not belong here; write it under [rig.cylinder]"),
        (
            "[rig.load]\nexpect = []\n",
            "rig.load.expect: belongs to the scenario itself; write expect = ... at the top of the file, "
            "before the first [section]",
        ),
        ("[rig.timeline]\nset = 1\n", "rig.timeline: a list of its own; write [[timeline]]"),
        ("[loop.alarm]\nwhen = 1\n", "loop.alarm: a list of its own; write [[alarm]]"),
        (
            "[rig.counterbalance]\nsetting = 1\n",
            'rig.counterbalance: a kind of accessory_a and accessory_b; write kind = "counterbalance" under '
            "[rig.accessory_a] or [rig.accessory_b]",
        ),
        ("[lever]\nmass = 1\n", 'lever: a kind of load; write kind = "lever" under [rig.load]'),
    ],
)
def test_a_key_of_another_section_is_told_which_one(tmp_path, text, line):
    assert said(tmp_path, PRESS + text) == [line]


def test_a_key_that_is_near_one_of_its_own_section_is_not_sent_away(tmp_path):
    (line,) = said(tmp_path, PRESS + "[rig.load]\nmas = 3\n")
    assert "did you mean 'mass'" in line


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("[daq]\nquantise = 'maybe'\n", "daq.quantise: 'maybe' is not true or false; write one of these"),
        ("[daq]\nchannels = 'p_pump'\n", "daq.channels: 'p_pump' is not a list; write [\"p_pump\"]"),
        ("[daq]\nbits = '14 mm'\n", "daq.bits: '14 mm': unit 'mm' does not fit here"),
        ("[daq]\nbits = 'many'\n", "daq.bits: cannot read 'many': write a number with a unit"),
        ("[rig]\nload = 3\n", "rig.load: 3 is not a section; write [rig.load], and its values below that"),
        ("[start]\nposition = []\n", "start.position: [] is not a number in m"),
        ("[allowed]\nrefused = '3 times'\n", "allowed.refused: '3 times' is not a whole number; write 3"),
        ("[allowed]\nrefused = 2.6\n", "allowed.refused: 2.6 is not a whole number; write one such as 3"),
        ("[rig.load]\nlift = [[1]]\n", "rig.load.lift.0.1: missing; write it"),
        ("[reference]\nkind = 'step'\n", "reference.start: missing; kind 'step' needs it: a number in m, or text"),
        ("[reference]\nmean = 'x'\n", "reference.mean: cannot read 'x'"),
        ("[loop]\nafter_timeout = 3\n", "loop.after_timeout: '3' is unknown (valid: latch, resume)"),
    ],
)
def test_a_value_of_the_wrong_type_gets_our_words(tmp_path, text, line):
    """One line each, with the value and the way out; nothing of pydantic's."""
    first = said(tmp_path, PRESS + text)[0]
    assert first.startswith(line)
    assert "input" not in first


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", 'reference: the section is missing; write [reference] with kind = "constant"'),
        ("reference = 3\n", "reference: 3 is not a section; write [reference], and its values below that"),
        ("[reference]\nvalue = 3\n", "reference: kind is missing; write one of constant, step, "),
        ("title = 3\n[reference]\nkind = 'constant'\nvalue = 0.1\n", 'title: 3 is not text; write "3"'),
        ("seed = '3'\nrig_name = 'a b'\n[reference]\nkind = 'constant'\nvalue = 0.1\n", "rig_name: 'a b' has other"),
    ],
)
def test_a_scenario_of_its_own_is_told_what_it_lacks(tmp_path, text, line):
    assert said(tmp_path, text)[0].startswith(line)


def test_bits_may_be_written_as_on_a_data_sheet(tmp_path):
    (tmp_path / "own.toml").write_text(PRESS + '[daq]\nbits = "14 bit"\nnoise = "0.7 LSB"\n')
    card = load(str(tmp_path / "own.toml")).daq
    assert (card.bits, card.noise) == (14.0, 0.7)


NO_ACCUMULATOR = PRESS + '[rig.accumulator]\nkind = "none"\n'
LEFT = ["p_pump", "accessory_a_lift"]


def test_inherited_channels_of_a_part_taken_away_go_with_it(tmp_path):
    """By a file, by a file on top of that, and by a change of the command line."""
    (tmp_path / "own.toml").write_text(NO_ACCUMULATOR)
    (tmp_path / "next.toml").write_text('extends = "own.toml"\n[rig.load]\nmass = 1500\n')
    assert load(str(tmp_path / "own.toml")).daq.channels == LEFT
    assert load(str(tmp_path / "next.toml")).daq.channels == LEFT
    assert load("press", ["rig.accumulator.kind=none"]).daq.channels == LEFT


def test_channels_of_ones_own_and_unknown_ones_stay_to_be_refused(tmp_path):
    own = '[daq]\nchannels = ["accumulator_oil"]\n'
    for text, changes in ((NO_ACCUMULATOR + own, []), (NO_ACCUMULATOR, ["daq.channels=['accumulator.oil']"])):
        (line,) = said(tmp_path, text, changes)
        assert "daq.channels: 'accumulator_oil' is not a channel of this drive" in line
    (tmp_path / "base.toml").write_text(PRESS + '[daq]\nchannels = ["accumulator_oill"]\n')
    (line,) = said(tmp_path, 'extends = "base.toml"\n[rig.accumulator]\nkind = "none"\n')
    assert "'accumulator_oill' is not a channel" in line
