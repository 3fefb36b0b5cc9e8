"""Whether a plant is lost, as those who work with it decide."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from bridge.processes.contact import DIRECT, RECONNECTING, Contact

STEP = 0.1  # [s] between two looks


class Scene:
    """A bus on which roles come and go, and a clock."""

    def __init__(self, is_expected: bool) -> None:
        self.now = 0.0
        self.bus = SimpleNamespace(session=SimpleNamespace(info=SimpleNamespace(routers_zid=list)), present={})
        self.contact = Contact(cast("Any", self.bus), is_expected, lambda: self.now)

    def seconds_until_lost(self, most: float = 60.0) -> float:
        begun = self.now
        while not self.contact.lost() and self.now < begun + most:
            self.now += STEP
        return self.now - begun


def test_a_plant_that_has_answered_and_is_never_seen_is_lost_after_a_while():
    """It was killed between its answer and its token: nobody tells that it has gone."""
    scene = Scene(is_expected=True)
    assert scene.seconds_until_lost() == pytest.approx(RECONNECTING, abs=2 * STEP)


def test_a_plant_without_token_is_there_as_long_as_it_is_heard():
    scene = Scene(is_expected=True)
    for _ in range(300):
        scene.now += STEP
        scene.contact.hear()
        assert not scene.contact.lost()
    assert scene.seconds_until_lost() == pytest.approx(RECONNECTING, abs=2 * STEP)


def test_a_plant_that_has_not_answered_is_waited_for():
    assert Scene(is_expected=False).seconds_until_lost() >= 60.0


def test_one_that_was_seen_is_lost_a_moment_after_it_has_gone_whoever_else_is_heard():
    scene = Scene(is_expected=True)
    scene.bus.present = {"plant": {"1"}}
    assert not scene.contact.lost()
    scene.bus.present = {"plant": set()}
    assert not scene.contact.lost()
    scene.contact.hear()
    assert scene.seconds_until_lost() == pytest.approx(DIRECT, abs=2 * STEP)
