"""What `describe` and `messages` say of a drive of one's own: origins, rest, taps, and what is likely a mistake."""

import json
import math
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from bridge.runs.check import Look
from bridge.runs.in_process import run_in_memory
from bridge.scenario import ScenarioError, load, names
from bridge.scenario.at_rest import holding_warnings, rest_facts
from bridge.scenario.bands import parse_band
from bridge.scenario.channels import rows_of
from bridge.scenario.circuit import circuit_of
from bridge.scenario.describe import values_of, warnings
from bridge.scenario.of_run import settings_of
from bridge.scenario.origins import origins
from bridge.scenario.plausible import missing_units
from bridge.scenario.taps import legend
from controller.bands import WindowBand
from tests.support.command import hydrotwin_here
from twin.circuit.parasitic import CLEAR, parasitic
from twin.lines.volume import inertance

DRIVES = ("press", "crane", "test-cylinder", "motor", "ehla")
OWN = 'extends = "press"\n[rig.load]\nmass = "1500 kg"\n[loop]\ndelay = "2 ms"\n'


@pytest.fixture
def own(tmp_path: Path) -> str:
    """A press of one's own, in a file."""
    (tmp_path / "own.toml").write_text(OWN)
    return str(tmp_path / "own.toml")


def test_what_comes_from_an_extended_scenario_is_not_marked_as_ones_own(own):
    inherited = origins(own, ["rig.cylinder.rod='80 mm'"])
    found = {v.name: v for v in values_of(load(own, ["rig.cylinder.rod='80 mm'"]), inherited)}
    assert found["cylinder.bore"].source == "press; otherwise 50 mm"
    assert found["cylinder.bore"].origin == "press"
    for name in ("load.mass", "cylinder.rod"):
        assert found[name].source.startswith("this scenario; otherwise ")
        assert not found[name].origin
    assert {v.name: v.origin for v in settings_of(load(own), origins(own)) if v.changed} == {
        "start.position": "press",
        "loop.sample_period": "press",
        "loop.delay": "",
        **dict.fromkeys(("controller.compensate_overlap", "controller.gain"), "press"),
        **dict.fromkeys((f"reference.{key}" for key in ("kind", "mean", "amplitude", "period")), "press"),
        **dict.fromkeys(("daq.position_range", "daq.pressure_range", "daq.channels"), "press"),
    }


def test_the_origin_is_the_scenario_that_says_it_last(tmp_path, own):
    (tmp_path / "next.toml").write_text('extends = "own.toml"\n[rig.load]\nforce = "1 N"\n')
    found = origins(str(tmp_path / "next.toml"))
    assert (found["rig.load.mass"], found["rig.cylinder.bore"]) == ("own", "press")
    assert "rig.load.force" not in found


def test_describe_prints_start_loop_controller_reference_card_and_rest(own, tmp_path):
    said = hydrotwin_here("describe", own, cwd=tmp_path).stdout
    for words in ("start.position", "350 mm", "loop.delay", "controller.gain", "reference.period", "8 s", "daq.bits"):
        assert words in said
    assert "p2 lower chamber 24.9 bar, p3 upper chamber 0 bar" in said
    plain = json.loads(hydrotwin_here("describe", own, "--json", cwd=tmp_path).stdout)
    assert {"name": "loop.delay", "value": "2 ms"}.items() <= plain["settings"][6].items()


def test_the_chamber_under_the_press_carries_its_weight():
    """m g / (pi/4 (D^2 - d^2))."""
    pressure = 2000.0 * 9.81 / (0.25 * math.pi * (0.125**2 - 0.09**2))
    (fact,) = rest_facts(load("press"))
    assert fact.value == f"p2 lower chamber {pressure / 1e5:.4g} bar, p3 upper chamber 0 bar"


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_a_counterbalance_valve_set_below_the_load_is_warned_of(factor):
    pressure = 2000.0 * 9.81 / (0.25 * math.pi * (0.125**2 - 0.09**2))
    said = holding_warnings(load("press", [f"rig.accessory_a.setting={factor * pressure}"]))
    assert bool(said) == (factor < 1.0)
    assert not said or f'"{1.3 * pressure / 1e5:.3g} bar"' in said[0]


def test_the_heaviest_place_of_a_lever_counts():
    """62 kN - 40 kg g at 0.15 m, over the cap side of 80 mm."""
    pressure = (62e3 + 40.0 * 9.81) / (0.25 * math.pi * 0.08**2)
    (said,) = holding_warnings(load("crane", ["rig.accessory_a.setting='100 bar'"]))
    assert f"{pressure / 1e5:.4g} bar at 150 mm" in said


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("rig.variable_pump.cut_off=180", '= 0.0018 bar, which is unlikely: if its unit is missing, write "180 bar"'),
        ("rig.variable_pump.displacement=28", 'write "28 cm^3"'),
        ("rig.variable_pump.speed=1450", 'write "1450 rpm"'),
        ("rig.accumulator.volume=2", 'write "2 l"'),
        ("rig.accumulator.precharge=130", 'write "130 bar"'),
        ("rig.pipe_1.diameter=40", 'write "40 mm"'),
        ("rig.accessory_a.setting=50", 'write "50 bar"'),
        ("rig.accessory_a.drop=10", 'write "10 bar"'),
        ("rig.valve.rated_flow=60", 'write "60 l/min"'),
        ("rig.load.mass=2e9", "usual is 0.0001 to 1e+06 kg"),
        ("daq.pressure_range=400", 'write "400 bar"'),
        ("loop.delay=2", 'write "2 ms"'),
        ("loop.delay=0.5", None),
        ("loop.sample_period=2", 'write "2 ms"'),
        ("rig.direct_relief.hysteresis=0", None),
        ("rig.cylinder.leakage_resistance=inf", None),
    ],
)
def test_a_value_that_likely_lacks_its_unit_is_warned_of(change, words):
    """With the value, what it means, and the spelling with a unit."""
    said = missing_units(load("press", [change]))
    assert len(said) == (words is not None)
    assert not said or (said[0].startswith(change.partition("=")[0]) and said[0].endswith(words))


def test_no_built_in_scenario_is_warned_of_and_no_default():
    for name in names():
        assert not missing_units(load(name)), name
    for name in DRIVES:
        assert not warnings(load(name)), name


def test_a_refusal_names_the_value_that_may_be_its_cause():
    scenario = load("press", ["rig.pipe_1.diameter=40"])
    with pytest.raises(ScenarioError) as error:
        circuit_of(scenario)
    (line,) = str(error.value).splitlines()
    assert line.startswith("press: pipe_1")
    assert 'write "40 mm"' in line


SMALL = ["rig.pipe_3.model=none", "rig.pipe_3.manifold='2 cm^3'"]


def test_a_small_manifold_beside_a_large_chamber_is_warned_of():
    """1/(2 pi sqrt(L C)) by the inertance of the scheme and the chamber in mid-stroke; a larger one is clear of it."""
    scenario = load("press", SMALL)
    (found,) = parasitic(circuit_of(scenario))
    inertia = inertance(SimpleNamespace(capacity=2e-6 / 1.6e9), scenario.loop.step)  # pyright: ignore[reportArgumentType]
    chamber = (150e-6 + 0.3 * 0.25 * math.pi * (0.125**2 - 0.09**2)) / 1.6e9
    assert found.frequency == pytest.approx(0.5 / math.pi / math.sqrt(inertia * chamber), rel=1e-6)
    assert found.frequency < CLEAR * found.load
    (said,) = [line for line in warnings(scenario) if "without inertia" in line]
    assert f"{found.frequency:.3g} Hz" in said
    assert not parasitic(circuit_of(load("press", [*SMALL, f"loop.step={1e-3 / math.ceil(1e-3 / found.step)}"])))
    assert not parasitic(circuit_of(load("press", ["rig.pipe_3.model=none", "rig.pipe_3.manifold='200 cm^3'"])))


@pytest.mark.parametrize(
    ("name", "lower", "upper"),
    [
        ("press", "lower chamber, rod side: it lifts", "upper chamber, cap side"),
        ("crane", "lower chamber, cap side: it lifts", "upper chamber, rod side"),
        ("motor", "chamber A, it turns forward", "chamber B, it turns back"),
        ("ehla", "chamber A, cap side: it extends the rod", "chamber B, rod side"),
        ("test-cylinder", "chamber A, rod side: it moves forward", "chamber B, rod side"),
    ],
)
def test_the_taps_are_told_in_the_words_of_the_drive(name, lower, upper):
    rows = {row[0]: row for row in legend(load(name))}
    assert rows["p2"] == ("p2", "p_lower", lower, "port A, pipe_3")
    assert rows["p3"] == ("p3", "p_upper", upper, "port B, pipe_4")


def test_messages_of_a_drive_begin_with_its_taps(tmp_path):
    said = hydrotwin_here("messages", "--scenario", "motor", cwd=tmp_path).stdout
    assert "it turns forward" in said
    assert "it lifts" not in said + hydrotwin_here("messages", cwd=tmp_path).stdout
    assert {row.name: row.reads for row in rows_of(load("motor"))}["p_lower"] == "gauge, chamber A"


def test_the_page_of_the_press_and_its_scenario_say_the_same():
    """Pipes of steel with the walls of the data sheet; (1 - 0.94) 28 cm^3 1450 rpm / 180 bar."""
    rig = load("press").rig_values()
    walls = [round(1e3 * rig[f"pipe_{i}"]["wall"], 6) for i in range(1, 7)]
    assert walls == [2.5] * 6
    assert {rig[f"pipe_{i}"]["young"] for i in range(1, 7)} == {2.1e11}
    assert rig["variable_pump"]["leakage"] == pytest.approx(0.06 * 28e-6 * 1450.0 / 60.0 / 180e5, rel=2e-3)
    page = (Path(__file__).parents[2] / "docs" / "own-drive.md").read_text()
    step_2 = next(block for block in page.split("```toml\n")[1:] if "[rig.variable_pump]" in block).partition("```")[0]
    told = tomllib.loads(step_2)["rig"]
    assert told["variable_pump"]["leakage"] == rig["variable_pump"]["leakage"]


def test_a_drive_without_a_force_balance_is_judged_by_its_other_bands():
    """A lever has none: its bands on signals are judged all the same, and a band on the balance is refused."""
    scenario = load("crane", ["duration='50 ms'"])
    look = Look(run_in_memory(scenario), scenario)
    assert look.series(window("least p_pump from start to end >= -1 bar"))[1].min() > -1e5
    assert np.isfinite(look.series(window("greatest sink_balance from start to end <= 1 m/s"))[1]).all()
    with pytest.raises(ScenarioError, match="force_balance is that of one mass"):
        look.series(window("greatest force_balance from start to end <= 1 bar"))


def window(text: str) -> WindowBand:
    """A band on a signal over the whole run."""
    band = parse_band(text)
    assert isinstance(band, WindowBand)
    return band
