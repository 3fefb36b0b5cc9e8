"""Recordings: in order, complete, read by readers that are not ours, and readable when cut off."""

import random
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from bridge.errors import UsageError
from bridge.processes.recorder.order import Order
from bridge.recording.digest import digest
from bridge.recording.reader import Recording, read
from bridge.recording.writer import LIST_OF_CHUNKS, ChunkIndexes, new_recording
from bridge.runs.in_process import record_in_process
from bridge.scenario import Scenario, load
from bridge.wire.messages import TOPICS


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load("step", ["duration=2"])


@pytest.fixture(scope="module")
def recording(scenario, tmp_path_factory) -> Recording:
    return record_in_process(scenario, tmp_path_factory.mktemp("recording") / "a.mcap")


def test_what_is_read_is_what_was_written(recording):
    again = read(recording.path)
    assert again.complete
    assert again.entries == recording.entries
    assert again.metadata["summary"] == recording.metadata["summary"]
    assert again.metadata["run"]["scenario"]["name"] == "step"


def test_every_topic_is_there_at_its_rate(recording):
    counts = {topic: sum(1 for _ in recording.of(topic)) for topic in TOPICS}
    assert counts["measurement"] == counts["state"] == 2001
    assert counts["command"] == counts["reference"] == 201
    assert counts["joint"] == counts["pressure/p1"] == 101
    assert counts["event"] == 2


def test_the_file_is_in_the_order_of_time_channel_and_sequence(recording):
    places = [(e.log_time, e.topic, e.sequence) for e in read(recording.path).entries]
    assert places == sorted(places)


def test_columns_are_the_messages(recording):
    columns, messages = recording.columns("state"), recording.messages("state")
    for name in ("stamp", "position", "p_lower", "oil_stored"):
        assert np.array_equal(columns[name], [getattr(m, name) for m in messages])


def test_a_reader_that_is_not_ours_reads_every_message(recording):
    """rosbags opens the file as a ROS 2 bag and decodes by the schemas in it."""
    with AnyReader([recording.path], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
        positions, count = [], 0
        for connection, _, raw in reader.messages():
            message: Any = reader.deserialize(raw, connection.msgtype)
            count += 1
            if connection.topic == "rig/measurement":
                positions.append(message.position)
    assert count == len(recording.entries)
    assert positions == recording.columns("measurement")["position"].tolist()


@pytest.mark.parametrize("share", [0.3, 0.7, 0.95])
def test_a_file_that_was_cut_off_is_read_up_to_the_cut(recording, tmp_path, share):
    cut = tmp_path / "cut.mcap"
    whole = recording.path.read_bytes()
    cut.write_bytes(whole[: int(len(whole) * share)])
    got = read(cut)
    assert not got.complete
    assert got.entries == recording.entries[: len(got.entries)]
    assert len(got.entries) > (share - 0.3) * len(recording.entries)
    assert got.scenario().name == "step"


def test_chunks_close_every_quarter_of_a_second(recording):
    """So much and not more is lost with a kill: file sizes between flushes never hold more than 0.25 s."""
    from mcap.reader import make_reader

    with recording.path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    spans = [(c.message_end_time - c.message_start_time) / 1e9 for c in summary.chunk_indexes]
    assert max(spans) <= 0.25


def test_what_is_no_recording_is_told_in_one_line(tmp_path):
    (tmp_path / "a.mcap").write_text("hello, I am no recording")
    for path in (tmp_path / "a.mcap", tmp_path / "none.mcap", tmp_path):
        with pytest.raises(UsageError) as error:
            read(Path(path))
        assert "\n" not in str(error.value)


def test_order_is_restored_whatever_way_messages_come(scenario, recording):
    """Each publisher's messages keep their order; the two publishers mix at random."""
    rng = random.Random(1)
    mine = {True: [], False: []}
    for _, group in groupby(recording.entries, key=lambda e: e.log_time):
        tick = sorted(group, key=lambda e: (e.topic != "measurement", e.topic))
        for entry in tick:
            mine[entry.topic in ("command", "reference")].append(entry)
    order, out = Order(scenario.loop.grid()), []
    while mine[True] or mine[False]:
        source = mine[rng.random() < 0.3]
        if source:
            out += order.add(*source.pop(0))
    out += order.rest()
    assert out == [tuple(entry) for entry in recording.entries]


def test_digests_see_every_bit(recording, tmp_path):
    first = digest(recording.path)
    assert digest(recording.path) == first
    record_in_process(load("step", ["duration=2", "seed=2"]), tmp_path / "b.mcap")
    other = digest(tmp_path / "b.mcap")
    assert other["measurement"] != first["measurement"]
    assert set(first) == {topic.name for topic in TOPICS.values() if topic.data}


def test_the_list_of_chunks_is_the_library_s_in_an_eighth_of_the_memory(recording, tmp_path, monkeypatch):
    """A recorder of a day has half a million chunks; the end of the file is the library's own, byte for byte."""
    files, kept = [], []
    for kind in (ChunkIndexes, list):
        monkeypatch.setattr("bridge.recording.writer.ChunkIndexes", kind)
        writer = new_recording(tmp_path / f"{kind.__name__}.mcap", "rig")
        for entry in recording.entries:
            writer.write(*entry)
            writer.flush_by(entry.log_time)
        kept.append(getattr(writer._writer, LIST_OF_CHUNKS))
        writer.close()
        files.append(writer.path.read_bytes())
    assert files[0] == files[1]
    assert 100 < len(kept[0]._records) / len(kept[1]) < 400


def test_a_message_of_a_time_that_is_none_is_left_out_and_counted(tmp_path):
    """Eight damaged bytes may say any time up to 2^64 ns."""
    path = tmp_path / "late.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("camera", "ros2msg", b"uint8 x")
        channel = writer.register_channel("rig/camera", "cdr", schema)
        for stamp in (0, (1 << 63) - 1, 1 << 63, (1 << 64) - 1):
            writer.add_message(channel, stamp, b"\0\1\0\0\7", stamp, 1)
        writer.finish()
    found = read(path)
    assert [entry.log_time for entry in found.entries] == [0, (1 << 63) - 1]
    assert found.damage.unreadable == 2
