"""A follower that joins a plant whose commands do not act: it has not heard what led there."""

import pytest

from bridge.loop.exchange import exchange, sides
from bridge.loop.follower import FollowerSide, Told
from bridge.scenario import load
from bridge.wire.messages import SafetyState
from tests.support.beside import hand
from twin.estimation.quantities import Standing
from twin.estimation.settings import Settings

LATCHING = 'alarm=[{when="position > 140 mm", then="latched"}]'
JOINED, RESET, END, STATUS = 700, 1200, 1600, 100  # ticks of 1 ms; between two statuses


@pytest.mark.parametrize("told", [True, False])
def test_it_learns_from_the_plant_s_status_that_commands_do_not_act(told: bool):
    """A latched piston stands still, its valve centred, whatever the controller says; from the reset on it follows."""
    scenario = load("sine", ["reference.amplitude=40 mm", "reference.at=0", f"duration={END / 1000} s", LATCHING])
    plant, controller = sides(scenario)
    side = FollowerSide(scenario, Settings())
    for tick, messages in enumerate(exchange(plant, controller, END)):
        if tick < JOINED:
            continue
        if tick == JOINED:
            assert plant.inlet.state == SafetyState.LATCHED
        hand(messages, side)
        reading = plant.status().reading
        assert reading is not None
        if told and tick % STATUS == 50:
            side.learn(Told(plant.now, plant.inlet.safe, reading.spool))
        if tick == RESET:
            assert side.latest is not None
            assert (side.state == SafetyState.LATCHED) == told
            assert (abs(side.latest.values["spool"]) < 1e-3) == told
            plant.reset()
    assert side.state == SafetyState.RUNNING
    if told:
        assert side.latest is not None
        assert side.latest.standing == Standing.FOLLOWING
        state = plant.true_state()
        assert side.latest.values["position"] == pytest.approx(state.position, abs=0.2e-3)
        assert side.latest.values["spool"] == pytest.approx(state.spool, abs=0.02)
