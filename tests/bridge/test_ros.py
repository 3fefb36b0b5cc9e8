"""A rig among the nodes of ROS 2: keys, tokens, attachments and hashes of rmw_zenoh, commands and orders back."""

import hashlib
import json
import os
import re
import struct
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
import zenoh

from bridge.connect.ros.bridging import HEARD, RosBridge
from bridge.connect.ros.package import package_files
from bridge.connect.ros.types import BRIDGE_MESSAGES, bridge_type, string, text_of, type_of
from bridge.recording.reader import read
from bridge.scenario.channels import layout_of
from bridge.wire.bus import Bus, stamp_of
from bridge.wire.codec import ValveCommand, channels_hash, encode, type_hash
from bridge.wire.link import Link, free_endpoint, open_session
from bridge.wire.messages import CHANNELS_TOPIC, PACKAGE, STANDARD_MESSAGES, TOPICS, VARYING
from tests.support.command import hydrotwin_here
from tests.support.processes import ROOT, started, wait_for
from tests.support.rig import SCENARIO, Rig

LAYOUT = layout_of(SCENARIO)
KNOWN = {  # published by ROS 2 itself, of Jazzy
    "std_msgs/msg/String": "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "sensor_msgs/msg/JointState": "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
}
NUMBERS = {"int32": 6, "uint32": 7, "int64": 8, "uint64": 9, "float64": 11, "string": 17}  # FieldType of rosidl
NESTED, SEQUENCE, EMPTY = 1, 144, "uint8 structure_needs_at_least_one_member"


def described(name: str, texts: dict[str, str]) -> dict[str, Any]:
    """A type as type_description_interfaces has it, by the rules of rosidl."""
    fields = []
    for kind, sequence, field in re.findall(r"^([\w/]+)(\[\])? +(\w+)", texts[name] or EMPTY, re.MULTILINE):
        nested = "" if kind in (*NUMBERS, "uint8") else kind.replace("/", "/msg/")
        number = (NESTED if nested else NUMBERS.get(kind, 3)) + (SEQUENCE if sequence else 0)
        type_ = {"type_id": number, "capacity": 0, "string_capacity": 0, "nested_type_name": nested}
        fields.append({"name": field, "type": type_})
    return {"type_name": name, "fields": fields}


def rihs01(name: str, texts: dict[str, str]) -> str:
    """REP 2016's hash of a type, worked out from its text alone."""
    own, waiting, needed = described(name, texts), [name], {}
    while waiting:
        for field in described(waiting.pop(), texts)["fields"]:
            inner = field["type"]["nested_type_name"]
            if inner and inner not in needed:
                needed[inner] = described(inner, texts)
                waiting.append(inner)
    whole = {"type_description": own, "referenced_type_descriptions": [needed[key] for key in sorted(needed)]}
    return f"RIHS01_{hashlib.sha256(json.dumps(whole).encode()).hexdigest()}"


def test_the_package_has_the_types_that_travel(tmp_path: Path):
    """Hashes of the files that colcon would build, by the rules of rosidl, are those in our keys and recordings."""
    done = hydrotwin_here("ros", "--package", ".", cwd=tmp_path)
    written = {Path(line) for line in done.stdout.split()}
    texts = {f"{PACKAGE}/{path.stem}": (tmp_path / path).read_text() for path in written if path.suffix == ".msg"}
    assert set(texts) == {topic.type for topic in TOPICS.values() if topic.type.startswith(PACKAGE)} - {VARYING}
    build = (tmp_path / "hydrotwin_msgs" / "CMakeLists.txt").read_text()
    for name in texts:
        assert rihs01(name, texts) == type_hash(name)
        assert f'"msg/{name.rpartition("/")[2]}.msg"' in build
    standard = STANDARD_MESSAGES | BRIDGE_MESSAGES
    for name in {*STANDARD_MESSAGES, *BRIDGE_MESSAGES}:
        ours = type_hash(name) if name in STANDARD_MESSAGES else bridge_type(name).hash
        assert rihs01(name, standard) == ours == KNOWN.get(name, ours)
    varying = {VARYING: package_files(LAYOUT)["msg/Channels.msg"]}
    assert rihs01(VARYING, varying) == channels_hash(LAYOUT) == type_of(CHANNELS_TOPIC, LAYOUT).hash


class Peer:
    """What a node of rmw_zenoh does, by its document: nothing of ours."""

    def __init__(self, address: str) -> None:
        self.session = open_session(Link(None, address, None, 20.0))
        self.heard: dict[str, list[Any]] = {}

    def tokens(self) -> list[list[str]]:
        replies = self.session.liveliness().get("@ros2_lv/0/**", timeout=2.0)
        return [str(reply.ok.key_expr).split("/") for reply in replies if reply.ok is not None]

    def listen(self, topic: str, type_: str) -> None:
        self.heard[topic] = []
        self.session.declare_subscriber(f"0{topic}/{type_}", self.heard[topic].append)


@pytest.fixture
def ros() -> Iterator[tuple[Rig, Peer, RosBridge]]:
    at, nodes = free_endpoint(), free_endpoint()
    rig = Rig(at)
    try:
        with (
            Bus(Link(None, at, None, 5.0), "rig", "viewer", blocking=True) as bus,
            open_session(Link(nodes, None, None, 5.0), "router") as session,
        ):
            bridge = RosBridge(bus, session, 0, {"mode": "lockstep", "scenario": SCENARIO.model_dump(mode="json")})
            bridge.join()
            over = threading.Event()
            running = threading.Thread(target=bridge.run, args=(over.is_set,))
            running.start()
            peer = Peer(nodes)
            try:
                yield rig, peer, bridge
            finally:
                over.set()
                running.join()
                peer.session.close()
    finally:
        rig.bus.close()


def test_nodes_find_topics_hear_every_message_and_the_time(ros: tuple[Rig, Peer, RosBridge]):
    rig, peer, _ = ros
    tokens = wait_for(lambda: len(found := peer.tokens()) > len(HEARD) + 4 and found, 20.0)
    kinds = [token[5] for token in tokens]
    assert (kinds.count("NN"), kinds.count("MS"), kinds.count("MP")) == (1, 3, len(HEARD) + 2)
    published = {token[9].replace("%", "/"): f"{token[10]}/{token[11]}" for token in tokens if token[5] == "MP"}
    measurement = f"hydrotwin_msgs::msg::dds_::Measurement_/{type_hash(f'{PACKAGE}/Measurement')}"
    assert published["/rig/measurement"] == measurement
    assert published["/clock"].startswith("rosgraph_msgs::msg::dds_::Clock_/RIHS01_692f7a66")
    for topic in ("/rig/measurement", "/rig/joint", "/rig/channels", "/clock"):
        peer.listen(topic, published[topic])
    time.sleep(0.3)  # until its subscriptions are known
    rig.advance(SCENARIO.ticks + 1)
    wait_for(lambda: len(peer.heard["/rig/measurement"]) == rig.sent["measurement"], 20.0)
    for topic in ("channels", "joint"):
        wait_for(lambda topic=topic: len(peer.heard[f"/rig/{topic}"]) == rig.sent[topic], 10.0)
    clocks = [struct.unpack("<4xiI", sample.payload.to_bytes()) for sample in peer.heard["/clock"]]
    assert clocks == [(0, k * 10_000_000) for k in range(21)]
    attached = [sample.attachment.to_bytes() for sample in peer.heard["/rig/measurement"]]
    assert {len(one) for one in attached} == {33}
    unpacked = [struct.unpack("<qqB16s", one) for one in attached]
    assert [one[:3] for one in unpacked] == [(k + 1, k * 1_000_000, 16) for k in range(len(unpacked))]
    assert len({one[3] for one in unpacked}) == 1
    last = peer.heard["/rig/measurement"][-1].payload.to_bytes()
    assert last == encode(rig.last["measurement"])


def test_commands_and_orders_of_nodes_reach_the_plant(ros: tuple[Rig, Peer, RosBridge]):
    """A node that publishes commands counts as a controller; what it sends does not come back to it."""
    rig, peer, bridge = ros
    commands: list[Any] = []
    rig.bus.session.declare_subscriber("rig/command", commands.append, allowed_origin=zenoh.Locality.REMOTE)
    rig.bus.watch()
    type_ = type_of("command", LAYOUT).path
    key = f"0/rig/command/{type_}"
    peer.listen("/rig/parameters/answer", bridge_type("std_msgs/msg/String").path)
    peer.listen("/rig/command", type_)
    token = f"@ros2_lv/0/{peer.session.info.zid()}/0/1/MP/%/%/steering/%rig%command/{type_}/::,10:,:,:,,"
    alive = peer.session.liveliness().declare_token(token)
    wait_for(lambda: rig.bus.present.get("controller"), 20.0)
    command = ValveCommand(run_id=1, source=2, sequence=3, sample_stamp=4, apply_at=5, spool=0.5)
    publisher = peer.session.declare_publisher(key, allowed_destination=zenoh.Locality.REMOTE)
    wait_for(lambda: publisher.matching_status.matching, 20.0)
    publisher.put(encode(command))
    (sample,) = wait_for(lambda: commands, 10.0)
    assert sample.payload.to_bytes() == encode(command)
    assert stamp_of(sample) == (4, 3)
    settings = f"0/rig/parameters/set/{bridge_type('std_msgs/msg/String').path}"
    peer.session.put(settings, string(json.dumps({"set": {"rig.load.force": "1 kN"}})))
    wait_for(lambda: bridge.taken["parameters/set"], 10.0)
    (answer,) = wait_for(lambda: peer.heard["/rig/parameters/answer"], 10.0)
    assert json.loads(text_of(answer.payload.to_bytes()))["set"] == {"rig.load.force": 1000.0}
    peer.session.put(f"0/rig/reset/{type_of('reset', LAYOUT).path}", b"\x00\x01\x00\x00\x00")
    wait_for(lambda: rig.resets, 10.0)
    alive.undeclare()
    wait_for(lambda: not rig.bus.present.get("controller"), 20.0)
    assert (len(commands), peer.heard["/rig/command"]) == (1, [])


def before_others(process: subprocess.Popen[str], mode: str) -> None:
    """In real time the bridge and the node take what the loop has taken, where that is granted."""
    if mode == "realtime":
        with suppress(PermissionError):
            os.sched_setscheduler(process.pid, os.SCHED_FIFO, os.sched_param(10))


@pytest.mark.endurance
@pytest.mark.timeout(400)
@pytest.mark.parametrize("mode", ["lockstep", "realtime"])
def test_a_controller_written_with_a_library_of_others_closes_the_loop(tmp_path: Path, mode: str):
    """zenoh-ros2-sdk lists the topics and steers, by the package's messages; it is installed by `make peers`."""
    python = ROOT / "build" / "peers" / "bin" / "python"
    if not python.is_file():
        pytest.skip("zenoh-ros2-sdk is not installed: make peers")
    hydrotwin_here("ros", "--package", ".", cwd=tmp_path)
    at, nodes = free_endpoint(), free_endpoint()
    words = ("run", "step", "--external", "--mode", mode, "--set", "duration=4", "--listen", at, "--patience", "90")
    with (
        started(*words, "--record", "run.mcap", "--json", "-", cwd=tmp_path) as run,
        started("ros", "--connect", at, "--listen", nodes, "--patience", "60", cwd=tmp_path) as bridge,
    ):
        before_others(bridge, mode)
        assert bridge.stdout is not None
        assert bridge.stdout.readline().startswith("/rig is at")
        command = [str(python), str(ROOT / "examples" / "ros_controller.py"), ".", nodes.rpartition(":")[2]]
        node = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        before_others(node, mode)
        told, wrong = node.communicate(timeout=150)
        assert "topics" in told, wrong
        assert int(told.split()[0]) >= 18  # ours, /clock and the answers
        assert "401 commands" in told
        assert run.wait(60) == 0, run.communicate()[0]  # good: late commands within what `step` allows
    recorded = read(tmp_path / "run.mcap")
    summary = recorded.metadata["summary"]
    commands, round_trip = summary["commands"], summary["timing"].get("round_trip")
    print(mode, commands, f"round trip [s]: {round_trip}")
    assert commands["taken"] >= commands["due"] == 400
    assert (commands["refused"], summary["safe_states"]) == ({}, 0)
    assert commands["late"] == 0 or mode == "realtime"
    position = recorded.columns("state")["position"]
    assert position[[1950, 3950]] == pytest.approx([0.16, 0.12], abs=1e-3)  # where the node steers to
