"""A drive with a servo valve for its user: safe state, dead band, linear model, description, what is refused."""

import pytest

from bridge.errors import ScenarioError
from bridge.loop.plant import PlantSide
from bridge.scenario import load
from bridge.scenario.describe import facts, values_of
from bridge.scenario.fitted_valve import overlap_of
from bridge.studies.linear_model import linear_model
from bridge.studies.stability.advice import plants_of
from bridge.studies.stability.amplitude import loop_of
from bridge.studies.stability.rig_loop import timing_of
from bridge.wire.codec import ValveCommand

MS, RUN, OWNER = 1_000_000, 5, 21
PLAIN = [
    "rig.minor_losses.kind=none",
    "rig.amplifier.kind=none",
]  # the compiled step of tests/twin/test_servo_circuit.py
SERVO = ["rig.valve.kind=servo", *PLAIN, "daq.noise=0", "daq.quantise_output=false", "loop.delay=0"]


def lapped(up: float, down: float) -> list[str]:
    """Overlap of the lands that open upwards, and downwards."""
    shares = {"p_a": up, "b_t": up, "p_b": down, "a_t": down}
    return [f"rig.servo_valve.overlap_{land}={share}" for land, share in shares.items()]


def plant(*changes: str) -> PlantSide:
    side = PlantSide(load("step", [*SERVO, "loop.command_timeout='20 ms'", *changes]), RUN)
    side.start()
    return side


def told(side: PlantSide, ticks: int) -> tuple[list[str], float]:
    """The texts of its safe states, and where the spool is after them."""
    said = [m for _ in range(ticks) for m in side.tick()]
    texts = [m.message.text for m in said if m.topic == "event" and m.message.kind == "safe"]
    return texts, [m.message.spool for m in said if m.topic == "state"][-1]


def test_without_commands_the_spool_goes_where_it_goes_without_power():
    """From its last command to -0.2, by its own dynamics; the event says so."""
    side = plant("rig.servo_valve.power_off=-0.2")
    assert side.take(ValveCommand(RUN, OWNER, 0, 0, 0, 0.5))
    texts, spool = told(side, 100)
    assert texts == ["no command for 0.02 s: valve without power, spool to -0.2"]
    assert spool == pytest.approx(-0.2, abs=1e-4)
    assert side.inlet.value == -0.2


def test_power_is_lost_too_where_nobody_has_spoken_yet():
    side = plant("rig.servo_valve.power_off=0.3")
    assert told(side, 100)[0] == [
        "no valid command within 0.02 s of the first that was due: valve without power, spool to 0.3"
    ]
    assert side.inlet.value == 0.3


def test_a_valve_that_centres_says_what_it_said():
    side = plant()
    assert side.take(ValveCommand(RUN, OWNER, 0, 0, 0, 0.5))
    assert told(side, 100)[0] == ["no command for 0.02 s: valve centred"]
    assert side.inlet.value == 0.0


@pytest.mark.parametrize(
    ("up", "down", "band"), [(0.05, 0.02, 0.02), (-0.01, 0.04, 0.0), (-0.01, -0.02, 0.0), (0.03, 0.03, 0.03)]
)
def test_the_law_jumps_no_more_than_the_smaller_dead_band(up: float, down: float, band: float):
    scenario = load("step", [*SERVO, *lapped(up, down), "rig.valve.overlap=0.1"])
    assert overlap_of(scenario) == band


def test_what_is_printed_of_it():
    scenario = load(
        "step", [*SERVO, "rig.servo_valve.opening=table", "rig.servo_valve.table=[[0, 0], ['40 %', 0.1], [1, 1]]"]
    )
    found = {fact.what: fact.value for fact in facts(scenario)}
    assert found["servo valve: lands fully open"].startswith("P-A ")
    assert float(found["servo valve: through it from P to T, spool in the middle"].split()[0]) > 0.0
    table = next(value for value in values_of(scenario) if value.name == "servo_valve.table")
    assert (table.value, table.changed) == ("0 0, 0.4 0.1, 1 1", True)


def test_linear_model_through_null_and_beside_it():
    """The rest of a leaking valve is one steady motion among others; the valve's delay counts to the loop's."""
    scenario = load("step", [*SERVO, "rig.servo_valve.delay='2 ms'", "loop.delay='1 ms'"])
    resting = linear_model(scenario, "rest")
    assert abs(resting.at["velocity"]) < 1e-7
    assert 0.0 < abs(resting.at["spool"]) < 0.1
    assert resting.delay == pytest.approx(3e-3)
    assert timing_of(scenario).delay == pytest.approx(3e-3)
    assert set(plants_of(scenario)) == {"rest", "up", "down"}
    assert linear_model(scenario, "0.3").at["velocity"] > 0.0


def test_the_reduced_loop_refuses_it_with_a_way_out():
    with pytest.raises(ScenarioError, match=r"servo.*: the reduced drive leaves it out; `hydrotwin advise` runs the"):
        loop_of(load("step", SERVO))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("rig.servo_valve.leakage='200 l/min'", "take less leakage"),
        ("rig.servo_valve.delay='1 s'", r"servo_valve.delay 1 s is 20000 steps"),
        ("rig.servo_valve.threshold=0.01", "servo_valve.hysteresis 0 is less than servo_valve.threshold 0.01"),
    ],
)
def test_numbers_that_make_no_valve_are_refused_in_a_line(change: str, words: str):
    with pytest.raises(ScenarioError, match=words):
        facts(load("step", [*SERVO, change]))
