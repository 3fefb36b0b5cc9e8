"""Scenario files: right ones load, wrong ones get one line that helps."""

import json
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bridge.errors import nearest
from bridge.scenario import Scenario, ScenarioError, check, load, names
from bridge.scenario.bands import METRICS, outside, parse_band
from bridge.scenario.circuit import circuit_of
from bridge.scenario.files import listed
from bridge.scenario.units import UNITS, quantity
from controller.bands import WHOLE, Band, Moment, WindowBand
from controller.reference import evaluate
from twin.quantity import Choice, Table
from twin.rig import RIG, values


def test_the_built_in_scenarios_are_there_and_load():
    runs = {f"{test}{rpm}" for test in ("load-change", "impingement") for rpm in ("", "-502", "-800", "-1035")}
    assert (
        set(names())
        >= {"step", "square", "sine", "slow-sampling", "delay", "hold-load", "start-up", "valve-slam"} | runs
    )
    for name in names():
        assert load(name).expect, f"{name} expects nothing"


def test_the_list_shows_what_the_checked_scenarios_say():
    """The list reads plain data; the model checks them."""
    for name in names():
        checked, shown = load(name), listed(name)
        assert shown == (checked.name, checked.title, checked.duration, [e.band for e in checked.expected])


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("loop.sample_perod=1", "loop.sample_perod: unknown key; did you mean 'sample_period'"),
        ("rig.load.mas=3", "rig.load.mas: unknown key; did you mean 'mass'"),
        ("loop.delay='2.5 mss'", "unit 'mss' does not fit here; did you mean 'ms'"),
        ("rig.load.mass='3 bar'", "unit 'bar' does not fit here"),
        ("loop.delay=0.00001", "nearest: 0 or 5e-05"),
        ("rig.valve.overlap=1.5", "rig.valve.overlap: 1.5 must be at most 0.9"),
        ("rig.valve.overlap=nan", "not a finite number"),
        ("duration=inf", "not a finite number"),
        ("controller.kind=pdd", "controller.kind: 'pdd' is unknown; did you mean 'pd'"),
        ("controller.law=pdd", "controller.law: 'pdd' is unknown; write controller.kind; did you mean 'pd'"),
        ("controller.law=relay", "controller.law: 'relay' is a kind of controller; write controller.kind = 'relay'"),
        ("controller.gain='3 V/mm'", "unit 'V/mm' does not fit here; did you mean 'V/%'? (valid: V/%, 1/m)"),
        ("reference.kind=stp", "'stp' is unknown; did you mean 'step'"),
        ("expect=['overshot <= 5 %']", "no metric 'overshot'; did you mean 'overshoot'"),
        ("expect=['overshoot <= 5 bar']", "unit 'bar' does not fit here"),
        ("expect=['limit cycle: maybe']", "'none' or 'present'"),
        ("start.position='3 m'", "lies outside the stroke"),
        ("rig.valve.kind=switchin", "rig.valve.kind: 'switchin' is unknown; did you mean 'switching'"),
        ("rig.pipe_2.model=wavy", "(valid: ends, nodes, lumped, volume, none)"),
        ("rig.pump.ripple=true", "rig.pump.ripple"),
        ("rig.oil.temperature=95", "must be at most 80"),
        ("controller.gain.x=1", "controller.gain"),
        ("controller.gain=nan", "not a finite gain"),
        ("controller.gain=true", "is not a gain"),
        ("daq.tachometer=false", "needs a tachometer"),
        ("loop.delay='11 s'", "loop.delay: 11.0 must be at most 10.0"),
        ("nonsense", "is not a change"),
    ],
)
def test_a_mistake_gets_one_line_that_names_it(change, said):
    with pytest.raises(ScenarioError) as error:
        load("step", [change])
    lines = str(error.value).splitlines()
    assert len(lines) == 1
    assert said in lines[0]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (["rig.load.mass=1"], "too light for the seal's friction"),
        (["rig.seal.limit=0", "rig.load.mass='5 g'"], "swings too fast on the oil"),
        (["rig.pipe_1.length='1 mm'"], "pipe_1, 0.001 m: travel time"),
        (["rig.pipe_3.length='0.05 m'"], "take a smaller loop.step, a longer pipe or model lumped"),
        (["rig.cylinder.rod='60 mm'"], "must be thinner than cylinder.bore"),
    ],
)
def test_numbers_that_make_no_circuit_are_refused_where_one_is_needed(changes, said):
    scenario = load("step", changes)
    with pytest.raises(ScenarioError) as error:
        circuit_of(scenario)
    lines = str(error.value).splitlines()
    assert len(lines) == 1
    assert lines[0].startswith("step: ")
    assert said in lines[0]


@pytest.mark.parametrize("step", ["1 us", "5 us", "12.5 us"])
def test_the_cards_own_skew_fits_every_step(step):
    assert load("step", [f"loop.step='{step}'"]).daq.skew == 5e-6


def test_a_longer_skew_must_fit_in_a_step():
    with pytest.raises(ScenarioError, match=r"daq\.skew 2e-05 s: at most 1\.25e-05 s"):
        load("step", ["daq.skew='20 us'"])


def test_an_unknown_scenario_names_its_neighbour():
    with pytest.raises(ScenarioError, match="did you mean 'step'"):
        load("stp")


@pytest.mark.parametrize("part", sorted(RIG))
def test_every_value_of_the_rig_can_be_given(part):
    """All values of a part, written out, are the scenario of before."""
    written = [f"rig.{part}.{name}={json.dumps(entry.value)}" for name, entry in RIG[part].items()]
    assert load("step", written).rig_values() == values()


CHOICES = [(part, name) for part in RIG for name, entry in RIG[part].items() if isinstance(entry, Choice)]


@pytest.mark.parametrize(("part", "name"), CHOICES)
def test_every_word_of_a_choice_can_be_set_and_no_other(part, name):
    """Each word makes a circuit; a wrong one is refused with the words there are."""
    entry = RIG[part][name]
    assert isinstance(entry, Choice)
    for word in entry.options:
        scenario = load("step", [f"rig.{part}.{name}={word}"])
        assert scenario.rig_values()[part][name] == word
        assert circuit_of(scenario).parts.step == scenario.loop.step
    with pytest.raises(ScenarioError) as error:
        load("step", [f"rig.{part}.{name}=nonsense"])
    assert f"rig.{part}.{name}: 'nonsense' is unknown" in str(error.value)
    assert f"(valid: {', '.join(entry.options)})" in str(error.value)


def test_every_value_has_a_source_and_every_number_a_known_unit():
    for entries in RIG.values():
        for entry in entries.values():
            assert entry.source
            if isinstance(entry, Choice):
                assert entry.value in entry.options
            else:
                assert set(entry.units if isinstance(entry, Table) else [entry.unit]) <= set(UNITS)


def test_a_scenario_survives_its_own_json():
    scenario = load("step", ["rig.cylinder.leakage_resistance=inf", "controller.gain=0.4"])
    again = check(json.loads(scenario.model_dump_json()), "again")
    assert again.model_dump(exclude={"rig"}) == scenario.model_dump(exclude={"rig"})
    assert again.rig_values() == scenario.rig_values()


def test_the_schema_names_every_section():
    schema = Scenario.model_json_schema()
    assert {"loop", "controller", "reference", "daq", "rig", "expect"} <= set(schema["properties"])


def test_a_table_is_read_from_beside_the_scenario(tmp_path):
    (tmp_path / "way.csv").write_text("time_s,position_m\n0,0.1\n1,0.2\n")
    (tmp_path / "own.toml").write_text('[reference]\nkind = "table"\ncsv = "way.csv"\n')
    scenario = load(str(tmp_path / "own.toml"))
    assert scenario.name == "own"
    assert evaluate(scenario.reference.reference(), 0.5).position == pytest.approx(0.15)


def test_broken_toml_and_missing_tables_are_told(tmp_path):
    (tmp_path / "bad.toml").write_text("duration = \n")
    with pytest.raises(ScenarioError, match="cannot be read"):
        load(str(tmp_path / "bad.toml"))
    (tmp_path / "own.toml").write_text('[reference]\nkind = "table"\ncsv = "none.csv"\n')
    with pytest.raises(ScenarioError, match=r"no file .*none\.csv"):
        load(str(tmp_path / "own.toml"))


@given(st.sampled_from(sorted(UNITS)), st.floats(-1e6, 1e6))
def test_units_convert_by_their_factor(unit, value):
    for name, (factor, offset) in UNITS[unit].items():
        assert quantity(f"{value!r} {name}", unit) == pytest.approx(value * factor + offset, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("metric", sorted(METRICS))
def test_a_band_for_every_metric(metric):
    shown = METRICS[metric]
    band = parse_band(f"{metric.replace('_', ' ')} <= 3 {shown.shown_unit.replace('travels', '')}")
    assert isinstance(band, Band)
    assert band == Band(metric, "<=", band.limit)
    assert band.limit == pytest.approx(3.0 / shown.factor)


@pytest.mark.parametrize(
    ("text", "way_out"),
    [
        ("overshoot <= 5", "5 has no unit, and would be 500 %: write '5 %'"),
        ("rms error <= 5", "write '5 mm'"),
        ("mean p1 >= 60", "write '60 bar'"),
        ("rms error from 3 to end <= 5 mm", "write '3 s' or another unit"),
        ("mean p1 from end - 3 to end <= 5 bar", "3 has no unit"),
        ("max error from end to end - 1 s <= 5 mm", "the window ends before it begins"),
        ("rms eror from 3 s to end <= 5 mm", "no signal 'eror'; did you mean 'error'"),
    ],
)
def test_a_band_without_unit_or_with_a_window_that_cannot_be_is_refused_in_one_line(text, way_out):
    with pytest.raises(ValueError, match=re.escape(way_out)) as found:
        parse_band(text)
    assert "\n" not in str(found.value)


def test_zero_and_what_has_no_unit_need_none():
    assert parse_band("limit cycle amplitude <= 0").limit == 0.0
    assert parse_band("valve travel <= 3").limit == parse_band("amplitude ratio <= 3").limit == 3.0
    assert parse_band("mean spool from 1 s to end <= 0.5").limit == 0.5


def test_bands_on_the_error_and_the_reference_over_windows():
    begin, end = Moment("start", 3.0), Moment("end", 0.0)
    assert parse_band("rms error from 3 s to end <= 5 mm") == Band("rms_error", "<=", 5e-3, begin, end)
    assert parse_band("overshoot from 3 s to end <= 5 %").begin == begin
    assert parse_band("mean error from 3 s to end <= 5 mm") == WindowBand("mean", "error", begin, end, "<=", 5e-3)
    assert parse_band("greatest reference <= 20 cm") == WindowBand("greatest", "reference", *WHOLE, "<=", 0.2)


@pytest.mark.parametrize("window", ["25 s to end", "1 s to 25 s", "end - 21 s to end", "start - 1 s to end"])
def test_a_window_outside_of_the_run_is_named(window):
    assert "which lasts from 0 s to 20 s" in (outside(parse_band(f"rms error from {window} <= 5 mm"), 20.0) or "")
    assert outside(parse_band("rms error from 1 s to end - 1 s <= 5 mm"), 20.0) is None
    assert outside(parse_band("mean p1 from impact + 30 s to end <= 5 bar"), 20.0) is None


def test_bands_take_units():
    assert parse_band("overshoot <= 5 %").limit == pytest.approx(0.05)
    assert parse_band("peak p_lower <= 80 bar").limit == 80e5
    assert parse_band("limit cycle: none").limit == 0.0


def test_a_suggestion_is_like_what_was_written():
    """`disturbance` is not a slip of `duration`, nor `kp` of anything; then only what there is is named."""
    assert nearest("durations", ["duration", "seed"]) == "; did you mean 'duration'? (valid: duration, seed)"
    assert nearest("disturbance", ["duration", "seed"]) == " (valid: duration, seed)"
    assert nearest("kp", ["gain", "compensate_overlap"], "or 1/m") == " (valid: gain, compensate_overlap, or 1/m)"


def test_gauge_pressures_may_be_given_as_absolute_ones():
    """1 bar of ambient, assumed; a drop or a modulus is a difference, and not above a vacuum."""
    changes = ["start.p_upper=3 bar abs", "rig.relief.setting=6800 kPa abs", "rig.oil.vapour_pressure=0 Pa abs"]
    found = load("step", changes)
    assert (found.start.p_upper, found.rig.relief.setting) == pytest.approx((2e5, 67e5))
    assert found.rig.oil.vapour_pressure == -1e5
    for name in ("valve.rated_drop", "filter.drop", "pipe_1.young", "accessory_a.cracking", "variable_pump.droop"):
        with pytest.raises(ScenarioError, match="write it without 'abs'") as refused:
            load("step", [f"rig.{name}=10 bar abs"])
        assert "\n" not in str(refused.value)
    with pytest.raises(ScenarioError, match=r"start.p_upper: -50000.0 must be at least 0.0"):
        load("step", ["start.p_upper=0.5 bar abs"])
