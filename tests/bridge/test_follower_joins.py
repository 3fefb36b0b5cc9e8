"""A follower beside a plant that runs: what it learns from its status when it joins, and how far it is behind."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bridge.errors import RunError
from bridge.loop.exchange import exchange, sides
from bridge.loop.follower import FollowerSide, Told
from bridge.processes.follower import FollowerProcess
from bridge.processes.listening import Ear
from bridge.runs.in_process import run_in_memory
from bridge.scenario import load
from bridge.wire.bus import STAMP
from bridge.wire.codec import Status, encode
from bridge.wire.intake import Turned
from bridge.wire.messages import Phase, SafetyState
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


def test_how_far_it_is_behind_counts_the_scans_that_wait():
    """Fifty scans have come while it was busy with the first."""
    publishers: dict[str, Any] = {}
    bus = quiet_bus(publishers)
    process = FollowerProcess(bus, FollowerSide(load("sine"), Settings()), lambda: False, quiet=True)
    rec = run_in_memory(load("sine", ["duration=0.05"]))
    scans = [entry.data for entry in rec.of("measurement")]
    for tick, data in enumerate(scans):
        publishers["measurement"](_sample(data, STAMP.pack(tick * 1_000_000, tick)))
    process.take("measurement", scans[0])
    assert process.behind == 50_000_000


def test_a_look_ahead_ends_with_its_plant():
    """The plant's last word says which tick was its last; nothing more comes, so nobody waits for it."""
    publishers: dict[str, Any] = {}
    ear = Ear(quiet_bus(publishers), FollowerSide(load("sine"), Settings()), [])
    scan = next(iter(run_in_memory(load("sine", ["duration=0.001"])).of("measurement")))
    values = {"tick": 0.0, "ticks": 1.0}
    head = {"run_id": 1, "sequence": 0, "stamp": 0, "role": "plant", "pid": 1, "text": ""}
    last = Status(**head, phase=Phase.ENDED, names=list(values), values=np.array([*values.values()]))
    for topic, data in (("measurement", scan.data), ("status", encode(last))):
        publishers[topic](_sample(data, STAMP.pack(0, 0)))
        ear.take()
    with pytest.raises(RunError, match="has ended"):
        ear.take()


def quiet_bus(publishers: dict[str, Any]) -> Any:
    """A bus on which nobody is; what is subscribed stands in `publishers`."""
    return SimpleNamespace(
        rig_name="rig", place="here", present={}, turned=Turned(), publish=lambda message: None,
        session=SimpleNamespace(info=SimpleNamespace(routers_zid=list)),
        subscribe=publishers.__setitem__, watch=lambda: None, announce=lambda: None,
    )  # fmt: skip


def _sample(data: bytes, stamp: bytes) -> Any:
    """A message as Zenoh hands it over."""
    return SimpleNamespace(
        payload=SimpleNamespace(to_bytes=lambda: data), attachment=SimpleNamespace(to_bytes=lambda: stamp)
    )
