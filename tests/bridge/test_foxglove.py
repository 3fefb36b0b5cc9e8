"""A rig in Foxglove: its own client decodes every topic, reads and sets numbers, calls services, plays a replay."""

import json
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast
from xml.etree import ElementTree

import pytest

from bridge.connect.foxglove.channels import HEARD
from bridge.connect.foxglove.listener import Listener
from bridge.connect.layouts import foxglove_layout, plotjuggler_layout
from bridge.recording.manifest import manifest
from bridge.replay.player import Player
from bridge.replay.remote import heeding
from bridge.replay.timeline import Timeline
from bridge.wire.bus import Bus
from bridge.wire.codec import Measurement
from bridge.wire.link import Link, free_endpoint
from bridge.wire.messages import TOPICS, Outgoing, Phase, field_names
from tests.support.command import hydrotwin_here
from tests.support.foxglove import Client, client, served
from tests.support.processes import wait_for
from tests.support.rig import MS, SCENARIO, Rig


@pytest.fixture
def rig() -> Iterator[tuple[Rig, Client]]:
    address = free_endpoint()
    rig = Rig(address)
    try:
        with served(Link(None, address, None, 5.0)) as at, client(at) as foxglove:
            wait_for(lambda: foxglove.ask("counts")["channels"] == len(HEARD), 20.0)
            time.sleep(0.2)  # until its subscriptions are there
            yield rig, foxglove
    finally:
        rig.bus.close()


def seen(foxglove: Client, topic: str) -> dict:
    return foxglove.ask("counts")["topics"].get(f"rig/{topic}", {"count": 0, "times": []})


def test_foxglove_decodes_every_message_of_every_topic(rig: tuple[Rig, Client]):
    """Nothing is lost, numbers are those of the wire, and times are simulated."""
    plant, foxglove = rig
    plant.advance(SCENARIO.ticks + 1)
    plant.bus.publish_status(plant.plant.run_id, 0, Phase.RUNNING, {"late": 1.0}, "all is well")
    wait_for(lambda: seen(foxglove, "status")["count"], 20.0)
    wait_for(lambda: all(seen(foxglove, topic)["count"] == n for topic, n in plant.sent.items()), 20.0)
    told = foxglove.ask("counts")
    assert told["errors"] == []
    assert {"measurement", "command", "state", "event", "joint", "pressure/p1", "lines", "channels"} < set(plant.sent)
    for topic, facts in told["topics"].items():
        assert facts["type"] == TOPICS[topic.removeprefix("rig/")].type
    for topic in ("measurement", "command", "state"):
        for name, value in told["topics"][f"rig/{topic}"]["last"].items():
            assert float(value) == float(getattr(plant.last[topic], name))  # 64-bit integers come as texts
    assert told["topics"]["rig/channels"]["last"]["force"] == plant.last["channels"].values[0]
    assert told["topics"]["rig/joint"]["last"]["position"] == plant.last["joint"].position.tolist()
    stamp = told["topics"]["rig/measurement"]["last"]["stamp"]
    assert told["topics"]["rig/measurement"]["times"][-1] == stamp == str(SCENARIO.ticks * MS)


def test_numbers_are_read_and_set_and_refused_as_everywhere(rig: tuple[Rig, Client]):
    plant, foxglove = rig
    before = {one["name"]: one["value"] for one in foxglove.ask("get", names=[])}
    assert set(before) == set(plant.plant.values())
    wanted = [{"name": "rig.load.force", "value": "0.5 kN"}, {"name": "sensor.p2.offset", "value": 1000.0}]
    foxglove.ask("set", parameters=wanted)
    plant.advance(5)
    after = {one["name"]: one["value"] for one in foxglove.ask("get", names=["rig.load.force", "sensor.p2.offset"])}
    assert after == {"rig.load.force": 500.0, "sensor.p2.offset": 1000.0}
    foxglove.ask("set", parameters=[{"name": "rig.load.mass", "value": -1.0}])
    wait_for(lambda: foxglove.ask("counts")["statuses"], 10.0)
    assert "rig.load.mass = -1" in foxglove.ask("counts")["statuses"][-1]


def test_services_are_the_orders_of_the_command_line(rig: tuple[Rig, Client]):
    plant, foxglove = rig
    told = foxglove.ask("counts")
    assert set(told["services"]) == {"rig/reset", "rig/recorder/save", "rig/parameters/set", "rig/fault"}
    assert foxglove.ask("call", service="rig/reset", request={}) == {"reset": "sent"}
    wait_for(lambda: plant.resets == [b"\x00\x01\x00\x00\x00"], 5.0)
    wanted = {"set": {"rig.load.force": "1 kN"}, "over": "1 s"}
    assert foxglove.ask("call", service="rig/parameters/set", request=wanted)["set"] == {"rig.load.force": 1000.0}
    refused = foxglove.ask("call", service="rig/parameters/set", request={"set": {"rig.load.forc": 1.0}})
    assert "did you mean 'rig.load.force'?" in refused["failed"]


class Replay:
    """A replay in this process: 2000 measurements, one per millisecond, played by a replay's own code."""

    def __init__(self, address: str) -> None:
        self.bus = Bus(Link(address, None, None, 5.0), "rig", "plant", blocking=True)
        told = manifest(SCENARIO, 1) | {"tick": 1, "replay_of": "run.mcap"}
        self.bus.answer("scenario", json.dumps(told).encode)
        self.player = Player(Timeline([k * MS for k in range(2001)], 0, 1.0, loop=True), self._send)
        self.player.timeline.paused = True

    def _send(self, indices: range) -> None:
        for k in indices:
            numbers = dict.fromkeys(field_names("hydrotwin_msgs/msg/Measurement"), 0.0)
            whole = {"run_id": 1, "sequence": k, "tick": k, "stamp": k * MS}
            self.bus.publish(Outgoing("measurement", k * MS, k, Measurement(**(numbers | whole))))


@pytest.fixture
def replay() -> Iterator[tuple[Replay, Client]]:
    address = free_endpoint()
    replay = Replay(address)
    playing = threading.Thread(target=replay.player.run)
    playing.start()
    try:
        with (
            heeding(replay.bus, "rig", replay.player),
            served(Link(None, address, None, 20.0)) as at,
            client(at) as foxglove,
        ):
            yield replay, foxglove
    finally:
        replay.player.stop()
        playing.join()
        replay.bus.close()


def test_the_play_bar_drives_a_replay(replay: tuple[Replay, Client]):
    """Bounds, seek, speed and pause; what comes after the seek is of then."""
    playing, foxglove = replay
    info = wait_for(lambda: foxglove.ask("counts")["server"], 10.0)
    assert "playbackControl" in info["capabilities"]
    assert (info["dataStartTime"], info["dataEndTime"]) == ({"sec": 0, "nsec": 0}, {"sec": 2, "nsec": 0})
    assert seen(foxglove, "measurement")["count"] == 0
    foxglove.ask("play", play=True, speed=0.5, seek=1_000_000_000)
    wait_for(lambda: seen(foxglove, "measurement")["count"] > 50, 20.0)
    assert int(seen(foxglove, "measurement")["times"][0]) >= 1_000_000_000
    assert playing.player.status()["speed"] == 0.5
    foxglove.ask("play", play=False, speed=2.0)
    wait_for(lambda: playing.player.status()["paused"], 10.0)
    assert playing.player.status()["speed"] == 2.0


def test_through_a_server_that_is_read_only_nothing_is_set():
    asking = SimpleNamespace(parameters=list, order=lambda *_: pytest.fail("it asked the plant"))
    pytest.importorskip("foxglove")
    said: list[str] = []
    listener = Listener(cast(Any, asking), True, said.append)
    listener.on_set_parameters(None, [SimpleNamespace(name="rig.load.force", get_value=lambda: 1.0)])
    assert "--read-only" in said[0]


def test_layouts_name_topics_and_fields_that_are_there(tmp_path: Path):
    """Every curve of both is a field of a message; the verb writes both files."""
    fields = {f"{name}.{field}" for name, topic in TOPICS.items() for field in field_names(topic.type)}
    panels = foxglove_layout("a/b")["configById"]
    plotted = [path["value"] for panel in panels.values() for path in panel.get("paths", [])]
    curves = [curve.get("name", "") for curve in ElementTree.fromstring(plotjuggler_layout("a/b")).iter("curve")]
    assert len(plotted) == len(curves) > 10
    assert {path.removeprefix("a/b/") for path in plotted} <= fields
    assert {".".join(curve.removeprefix("a/b/").rsplit("/", 1)) for curve in curves} <= fields
    done = hydrotwin_here("foxglove", "rig", "--layouts", "lay", cwd=tmp_path)
    assert done.stdout.split() == ["lay/rig-foxglove.json", "lay/rig-plotjuggler.xml"]


def test_without_the_extra_one_sentence(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setitem(sys.modules, "foxglove", None)
    done = hydrotwin_here("foxglove", cwd=tmp_path)
    assert (done.returncode, done.stderr.strip()) == (
        2,
        "hydrotwin: Foxglove's SDK is not installed: pip install 'hydrotwin[foxglove]'",
    )
