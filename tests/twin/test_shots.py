"""Twins that run freely beside a rig: those with its numbers stay with it, the others do not."""

from collections.abc import Mapping

import numpy as np
import pytest

from bridge.loop.exchange import exchange, sides
from bridge.loop.follower import FollowerSide
from bridge.scenario import load
from tests.support.beside import hand
from twin.estimation.settings import Settings
from twin.estimation.shots import SHOT, Shots
from twin.topology import CHANNELS

OFFSET = 2e5  # [Pa]


def test_a_wrong_number_shows_and_a_right_one_does_not():
    """After a shot the rig's own twin is within errors of the model; one with a wrong offset, or gain, is not."""
    scenario = load("sine", ["duration=2.2 s", "reference.amplitude=25 mm", "reference.frequency=1 Hz"])
    side = FollowerSide(scenario, Settings())
    plant, controller = sides(scenario)
    names = (*side.filter.names, "offset_p2")
    z = np.zeros((3, len(names)))
    z[1, names.index("offset_p2")] = OFFSET
    z[2, names.index("valve_gain")] = -0.1
    beside: list[Shots] = []
    squares, count = np.zeros((3, len(CHANNELS))), 0
    advance, look = side.filter.advance, side.filter.look

    def advanced(reference: float, steps: int) -> None:
        advance(reference, steps)
        for shots in beside:
            shots.advance(reference, steps)

    def looked(readings: Mapping[str, float]) -> None:
        nonlocal squares, count
        look(readings)
        for shots in beside:
            away = shots.look(readings)
            if away is not None and not shots.over:
                squares, count = squares + np.nan_to_num(away) ** 2, count + 1

    side.filter.advance, side.filter.look = advanced, looked
    for tick, messages in enumerate(exchange(plant, controller, scenario.ticks)):
        hand(messages, side)
        if tick == 1500:
            beside.append(Shots(side.filter, names, z))
            beside[0].begin()
    assert beside[0].over
    assert count == pytest.approx(1000 * SHOT - 100, abs=6)
    right, offset, gain = np.sqrt(squares / count)
    error = dict(zip(CHANNELS, Settings().model_errors().values(), strict=True))
    for place, name in enumerate(CHANNELS):
        assert right[place] < 2.0 * error[name], name
    assert gain[[*CHANNELS].index("position")] > 10.0 * right[[*CHANNELS].index("position")]
    assert offset[[*CHANNELS].index("p2")] > 1e5
