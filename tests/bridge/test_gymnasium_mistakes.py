"""Mistakes in making or using the environment for learning: each gets one sentence."""

import importlib
import re
import sys
from typing import Any

import numpy as np
import pytest

import hydrotwin as ht
from hydrotwin.gym import Rig

SHORT = {"duration": 0.3, "reference.at": 0.05}


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"scenario": "stp"}, "stp: no such scenario or file; did you mean 'step'"),
        ({"scenario": "impingement"}, "its reference is a spool position"),
        ({"changes": {"loop.offset": 30}}, "offset 30 s is not before the end at 20 s"),
        ({"actions": 0}, "actions 0: how many"),
        ({"randomise": {"rig.load.mas": (1, 2)}}, "rig.load.mas: unknown key; did you mean 'mass'"),
        ({"randomise": {"load.mass": (1, 2)}}, "randomise 'load.mass': not a number of the rig"),
        ({"randomise": {"controller.gain": (1, 2)}}, "randomise 'controller.gain': not a number of the rig"),
        ({"randomise": {"rig.load.mass": (-5, 200)}}, "rig.load.mass: -5.0 must be at least"),
        ({"randomise": {"rig.load.mass": (300, 120)}}, "the range 300 to 120 must rise"),
        ({"randomise": {"rig.load.mass": 150}}, "150 is not a range; give (low, high)"),
        ({"randomise": {"rig.load.mass": ("1 m", 200)}}, "unit 'm' does not fit here"),
        ({"randomise": {"rig.valve.kind": ("proportional", "switching")}}, "is not a finite number"),
        ({"randomise": {"loop.delay": ("0 ms", "0.12 ms")}}, "nearest: 0.0001 or 0.00015 s"),
        ({"randomise": {"rig.cylinder.rod": ("10 mm", "80 mm")}}, "must be thinner than cylinder.bore"),
        ({"bands": ["p9 <= 5 bar"]}, "bands 'p9 <= 5 bar': no signal 'p9'"),
        ({"bands": ["p1 <= 120"]}, "120 has no unit"),
        ({"bands": ["p1 < 120 bar"]}, "write 'signal <= value unit'"),
        ({"bands": ["overshoot <= 5 %"]}, "'overshoot' is known when a run is over"),
        ({"limits": ["least p1 <= 5 bar"]}, "leave 'least' out"),
    ],
)
def test_a_mistake_in_making_it_gets_one_sentence(options: dict[str, Any], sentence: str):
    with pytest.raises(ht.UsageError, match=re.escape(sentence)) as found:
        Rig(**options)
    assert "\n" not in str(found.value)


@pytest.mark.parametrize(
    ("action", "sentence"),
    [
        (np.zeros(2), "action has shape (2,), expected (1,): the spool command, -1 to 1"),
        (0.5, "action has shape (), expected (1,)"),
        (np.array([np.nan]), "action is nan, expected a number from -1 to 1"),
        (np.array([np.inf]), "action is inf"),
        (["up"], "action ['up'] is not an array of numbers"),
        (None, "expected"),
    ],
)
def test_a_mistake_in_an_action_gets_one_sentence(action: Any, sentence: str):
    env = Rig("step", SHORT)
    with pytest.raises(ht.UsageError, match="call reset"):
        env.step(np.zeros(1))
    env.reset(seed=1)
    with pytest.raises(ht.UsageError, match=re.escape(sentence)):
        env.step(action)
    *_, terminated, truncated, _ = env.step(np.zeros(1))
    assert not terminated
    assert not truncated


def test_mistakes_in_an_episode_get_one_sentence():
    env = Rig("step", {"duration": 0.01}, randomise={"start.position": ("0 mm", "200 mm")})
    with pytest.raises(ht.UsageError, match=r"options 'loop\.step': not a number"):
        env.reset(options={"loop.step": 1e-4})
    with pytest.raises(ht.UsageError, match=r"no rig with .*start\.position 0\.2 m lies outside the stroke"):
        env.reset(options={"rig.cylinder.stroke": "150 mm", "start.position": "200 mm"})
    with pytest.raises(ht.UsageError, match="record=True"):
        env.episode()
    env.reset()
    env.step(np.zeros(1))
    with pytest.raises(ht.UsageError, match="has ended: call reset"):
        env.step(np.zeros(1))
    nothing = Rig("step", SHORT, reward=lambda step: None, record=True)  # pyright: ignore[reportArgumentType]
    with pytest.raises(ht.UsageError, match="no episode has ended"):
        nothing.episode()
    nothing.reset()
    with pytest.raises(ht.UsageError, match=r"the reward at 0\.01 s is None, expected a finite number"):
        nothing.step(np.zeros(1))


def test_without_gymnasium_one_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    monkeypatch.delitem(sys.modules, "hydrotwin.gym.rig")
    with pytest.raises(ImportError, match=r"pip install 'hydrotwin\[gym\]'"):
        importlib.import_module("hydrotwin.gym.rig")
