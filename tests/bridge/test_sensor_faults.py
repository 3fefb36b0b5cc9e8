"""Faults of sensors: each is there in its window alone, and reads what its name says."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from bridge.loop.fault_chance import Luck
from bridge.runs.in_process import run_in_memory
from bridge.scenario import Scenario, load
from bridge.scenario.fault_kinds import SENSOR
from controller.grid import NS
from tests.support.faults import BAR, BEGIN, END, faulty, one

PERFECT = ("daq.noise=0", "daq.quantise=false", "daq.skew=0", "daq.clip=false", "rig.amplifier.kind=none")


def sampled(made: Scenario) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, the true pressure of the lower chamber, and what the card says of it."""
    run = run_in_memory(made)
    state, read = run.columns("state"), run.columns("measurement")
    return state["stamp"] / NS, state["p_lower"], read["p2"]


Lie = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]  # of times, true values, and times since the beginning
STUCK = round(BEGIN / 1e-3)
SENSOR_KINDS: dict[str, tuple[str, Lie]] = {
    "off": ("", lambda t, true, since: np.zeros_like(true)),
    "stuck": ("", lambda t, true, since: np.full_like(true, true[STUCK])),
    "bias": ('size="3 bar"', lambda t, true, since: true + 3 * BAR),
    "drift": ('rate="20 bar/s"', lambda t, true, since: true + 20 * BAR * since),
    "gain": ("factor=1.2", lambda t, true, since: 1.2 * true),
    "noise": ('size="1 bar"', lambda t, true, since: true + BAR * _normal(t, "sensor.p2 noise scan")),
    "spikes": (
        'size="30 bar", share=0.1',
        lambda t, true, since: true + 30 * BAR * (_uniform(t, "sensor.p2 spikes scan") < 0.1),
    ),
    "quantisation": ('size="2 bar"', lambda t, true, since: 2 * BAR * np.floor(true / (2 * BAR) + 0.5)),
    "saturation": ('low="12 bar", high="14 bar"', lambda t, true, since: np.clip(true, 12 * BAR, 14 * BAR)),
    "delay": ('time="20 ms"', lambda t, true, since: np.concatenate([true[:20], true[:-20]])),
}


def _normal(t: np.ndarray, name: str) -> np.ndarray:
    return np.array([Luck(1, name).normal(round(time * 1000)) for time in t])


def _uniform(t: np.ndarray, name: str) -> np.ndarray:
    return np.array([Luck(1, name).uniform(round(time * 1000)) for time in t])


@pytest.mark.parametrize("kind", SENSOR_KINDS)
def test_a_sensor_lies_as_its_kind_says_in_its_window_alone(kind: str):
    """With a perfect card: what is read is a stated function of what is true; the loop does not read this channel."""
    sizes, lie = SENSOR_KINDS[kind]
    t, true, read = sampled(faulty(one("sensor.p2", kind, sizes), changes=PERFECT))
    inside = (t > BEGIN - 1e-6) & (t < END - 1e-6)
    assert read[~inside] == pytest.approx(true[~inside], abs=1e-3)
    assert read[inside] == pytest.approx(lie(t, true, t - BEGIN)[inside], abs=1e-3)
    assert np.abs(read[inside] - true[inside]).max() > 0.1 * BAR


def test_a_wrong_channel_reads_the_other_s_volts():
    run = run_in_memory(faulty(one("sensor.p2", "wrong-channel", 'instead="p3"'), changes=PERFECT))
    read, t = run.columns("measurement"), run.columns("state")["stamp"] / NS
    inside = (t > BEGIN - 1e-6) & (t < END - 1e-6)
    assert (read["p2"][inside] == read["p3"][inside]).all()
    other = run_in_memory(faulty(one("sensor.p2", "wrong-channel", 'instead="position"'), changes=PERFECT))
    read = other.columns("measurement")
    assert read["p2"][inside] == pytest.approx(read["position"][inside] / 0.3 * 250 * BAR, rel=1e-9)


def test_an_intermittent_sensor_reads_nothing_for_its_share_of_the_time():
    """Spells and times between them are exponential: the share within 4 deviations, over a minute of a still rig."""
    fault = one("sensor.p2", "intermittent", 'share=0.3, length="20 ms"', "at=0.0")
    made = load("hold-load", [f"fault=[{fault}]", "duration=4", *PERFECT, "expect=[]"])
    read = run_in_memory(made).columns("measurement")["p2"]
    share = (read == 0.0).mean()
    spells = 4.0 * 0.3 / 20e-3
    assert share == pytest.approx(0.3, abs=4.0 * 0.3 / math.sqrt(spells))


def test_every_kind_of_sensor_fault_has_its_test():
    assert {*SENSOR_KINDS, "wrong-channel", "intermittent"} == {*SENSOR}


def test_a_further_channel_lies_too():
    fault = one("channel.p_pump", "bias", 'size="5 bar"')
    runs = [run_in_memory(faulty(*own, changes=('daq.channels=["p_pump"]', "daq.noise=0"))) for own in ((), (fault,))]
    read = [np.array([message.values[0] for message in run.messages("channels")]) for run in runs]
    apart = (read[1] - read[0]) / BAR
    t = np.arange(len(apart)) * 1e-3
    inside = (t > BEGIN - 1e-6) & (t < END - 1e-6)
    assert apart[inside] == pytest.approx(5.0, abs=0.07)
    assert not apart[~inside].any()
