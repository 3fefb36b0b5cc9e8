"""A recording as others read it, untouched: rosbags, mcap's own reader, Rerun's loader; the same counts and values."""

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from bridge.recording.reader import Recording
from bridge.runs.in_process import record_in_process
from bridge.scenario import load

CHECKED = {"measurement": "p2", "state": "position", "command": "spool", "pressure/p1": "fluid_pressure"}
Found = tuple[dict[str, int], dict[str, list[float]]]  # messages per topic, values of the fields above


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> Recording:
    return record_in_process(load("step", ["duration=1.5"]), tmp_path_factory.mktemp("readers") / "a.mcap")


@pytest.fixture(scope="module")
def ours(recording) -> Found:
    values = {topic: [float(getattr(m, field)) for m in recording.messages(topic)] for topic, field in CHECKED.items()}
    return {f"rig/{topic}": count for topic, count in recording.counts.items()}, values


def test_rosbags_reads_every_message_by_the_schemas_in_the_file(recording, ours):
    counts, values = dict.fromkeys(ours[0], 0), {topic: [] for topic in CHECKED}
    with AnyReader([recording.path], default_typestore=get_typestore(Stores.EMPTY)) as reader:
        for connection, _, raw in reader.messages():
            message: Any = reader.deserialize(raw, connection.msgtype)
            counts[connection.topic] += 1
            name = connection.topic.removeprefix("rig/")
            if name in CHECKED:
                values[name].append(float(getattr(message, CHECKED[name])))
    assert (counts, values) == ours


def test_mcaps_own_reader_reads_every_message(recording, ours):
    """The payloads by nothing but the schema text beside them; index and statistics agree with what is there."""
    counts, values = dict.fromkeys(ours[0], 0), {topic: [] for topic in CHECKED}
    stores: dict[str, Any] = {}
    with recording.path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary: Any = reader.get_summary()
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
            counts[channel.topic] += 1
            name = channel.topic.removeprefix("rig/")
            if name in CHECKED:
                if schema.name not in stores:
                    stores[schema.name] = get_typestore(Stores.EMPTY)
                    stores[schema.name].register(get_types_from_msg(schema.data.decode(), schema.name))
                value: Any = stores[schema.name].deserialize_cdr(message.data, schema.name)
                values[name].append(float(getattr(value, CHECKED[name])))
        header = reader.get_header()
    assert header.profile == "ros2"
    assert (counts, values) == ours
    assert summary.statistics.message_count == sum(counts.values())


def test_reruns_loader_reads_every_message(recording, ours):
    if find_spec("rerun") is None:
        pytest.skip("rerun-sdk is not installed: pip install 'hydrotwin[view]'")
    counts, values = _rerun(recording.path)
    assert counts == ours[0]
    assert values == ours[1]


def _rerun(path: Path) -> Found:
    """Rows of each entity by its columns (the loader may part a message into several), and values as Arrow has them."""
    from rerun.chunk import McapReader

    rows: dict[tuple[str, tuple[str, ...]], int] = {}
    values: dict[str, list[tuple[int, float]]] = {topic: [] for topic in CHECKED}
    for chunk in McapReader(path).stream():
        if "message_log_time" not in chunk.timeline_names:
            continue
        batch, entity = chunk.to_record_batch(), str(chunk.entity_path).strip("/")
        key = entity, tuple(batch.schema.names)
        rows[key] = rows.get(key, 0) + batch.num_rows
        topic = entity.removeprefix("rig/")
        if topic in CHECKED:
            times = np.array(batch.column("message_log_time").cast("int64")).tolist()
            values[topic] += zip(times, _values(batch, CHECKED[topic]), strict=True)
    counts: dict[str, int] = {}
    for (place, _), count in rows.items():
        entity = "rig/joint" if place.startswith("rig/joint/") else place  # a joint's fields have places of their own
        counts[entity] = max(count, counts.get(entity, 0))
    return counts, {topic: [value for _, value in sorted(found)] for topic, found in values.items()}


def _values(batch: Any, field: str) -> list[float]:
    """One field of every message: of a standard type from what Rerun makes of it."""
    name = next((name for name in batch.schema.names if name.endswith(":message")), "Measurements:values")
    return [float(row[0][field] if isinstance(row[0], dict) else row[0]) for row in batch.column(name).to_pylist()]


def test_every_channel_says_what_ros2_bag_play_asks_for(recording):
    with recording.path.open("rb") as file:
        summary: Any = make_reader(file).get_summary()
    for channel in summary.channels.values():
        (profile,) = yaml.safe_load(channel.metadata["offered_qos_profiles"])
        assert {"history", "depth", "reliability", "durability", "deadline", "lifespan", "liveliness"} <= set(profile)
        assert channel.metadata["topic_type_hash"].startswith("RIHS01_")


def test_numbers_are_the_same_bit_for_bit(recording, ours):
    assert np.array_equal(recording.columns("state")["position"], ours[1]["state"])
