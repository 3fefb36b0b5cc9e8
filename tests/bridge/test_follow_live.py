"""A follower beside a rig that runs: what it publishes is recorded, and is what a recording gives, bit for bit."""

import json
from pathlib import Path

from bridge.loop.follower import FollowerSide
from bridge.recording.reader import read
from bridge.replay.into_follower import through_follower
from bridge.wire.access import Role, rights
from bridge.wire.codec import encode
from bridge.wire.link import free_endpoint
from bridge.wire.messages import ESTIMATE, HEALTH, INNOVATION
from tests.support.processes import hydrotwin, listening, started, wait_for
from twin.estimation.settings import Settings

MEMBERS = 24
PATIENCE = ("--patience", "90")  # the first start compiles


def test_a_follower_in_lockstep_says_what_the_recording_gives(tmp_path: Path):
    endpoint, path = free_endpoint(), tmp_path / "a.mcap"
    lockstep, to = ("--mode", "lockstep"), ("--connect", endpoint)
    awaited = [word for role in ("controller", "recorder", "follower") for word in ("--await", role)]
    short = ("--set", "duration=0.4", "--set", "loop.delay=5 ms")
    with started("plant", "sine", *short, *lockstep, *awaited, *PATIENCE, "--listen", endpoint) as plant:
        wait_for(lambda: listening(endpoint), 90)
        with (
            started("record", *lockstep, *to, *PATIENCE, "-o", str(path)) as recorder,
            started(
                "follow", "rig", *lockstep, *to, *PATIENCE, "--members", str(MEMBERS), "--quiet", "--json"
            ) as follower,
        ):
            controller = hydrotwin("controller", "sine", *short, *lockstep, *to, *PATIENCE)
            said, _ = follower.communicate(timeout=60)
            recorder.communicate(timeout=60)
            plant.communicate(timeout=60)
    assert controller.returncode == 0, controller.stderr
    recording = read(path)
    side = FollowerSide(recording.scenario(), Settings(members=MEMBERS))
    mine = [m for messages in through_follower(recording, side) for m in messages]
    for topic in (ESTIMATE, INNOVATION):
        recorded = [entry.data for entry in recording.of(topic)]
        assert recorded == [encode(m.message) for m in mine if m.topic == topic]
        assert len(recorded) == 80  # each 5 ms
    assert json.loads(said)["estimates"] == 80


def test_a_follower_may_publish_its_own_topics_and_nothing_else():
    own = rights(Role.FOLLOWER)
    assert set(own.puts) == {ESTIMATE, INNOVATION, HEALTH, "status"}
    assert not own.queries
    assert not own.answers
