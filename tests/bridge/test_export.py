"""Exports that other programs read with libraries of their own: MDF 4 by asammdf, a bag of ROS 2 by rosbags."""

import sys
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from bridge.errors import UsageError
from bridge.recording.export import export
from bridge.recording.logs.importing import imported
from bridge.recording.logs.map import parsed_map
from bridge.recording.logs.measured import measured
from bridge.recording.reader import Recording, read
from bridge.recording.tables import table
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire.messages import TOPICS
from tests.support.command import hydrotwin_here

MAP = """
rig = "step"
period = "1 ms"
[signal.command]
column = "command.spool"
[signal.position]
column = "measurement.position"
[signal.p2]
column = "measurement.p2"
[signal.force]
column = "channels.force"
[scenario.daq]
channels = ["force"]
"""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    path = tmp_path_factory.mktemp("export") / "run.mcap"
    return read(record_in_process(load("step", ["duration=0.2", "loop.delay=0", 'daq.channels=["force"]']), path).path)


def test_mdf_holds_every_topic_with_units_and_comments(recorded: Recording, tmp_path: Path):
    """By asammdf: a group per topic, a row per message, every number as it was; the import reads the same back."""
    asammdf = pytest.importorskip("asammdf")
    hydrotwin_here("export", str(recorded.path), "--mdf", "-o", "run.mf4", cwd=tmp_path)
    with asammdf.MDF(tmp_path / "run.mf4") as file:
        assert {g.channel_group.acq_name: g.channel_group.cycles_nr for g in file.groups} == recorded.counts
        assert file.start_time.strftime("%Y-%m-%dT%H:%M:%S") == recorded.metadata["run"]["recorded"][:19]
        for topic in recorded.counts:
            time, *columns = table(recorded, topic)
            for column in columns:
                signal = file.get(f"{topic}.{column.name}")
                assert (signal.timestamps == time.values).all()
                assert (signal.unit, signal.comment) == (column.unit, column.comment)
                texts = isinstance(column.values, list)
                read_back = [text.decode() for text in signal.samples] if texts else signal.samples
                np.testing.assert_array_equal(read_back, column.values)
        known = file.get("measurement.p2")
        assert (known.unit, known.comment) == ("Pa", "gauge, p_lower: chamber of port A (pipe_3)")
    made = imported(tmp_path / "run.mf4", parsed_map(MAP, "map"), tmp_path / "map.toml")
    rows, before = measured(made.recording), measured(recorded)
    for signal in ("position", "p2", "force"):
        np.testing.assert_array_equal(rows.signals[signal], before.signals[signal])
    np.testing.assert_array_equal(rows.command, before.command)


def test_a_bag_is_read_by_rosbags_alone(recorded: Recording, tmp_path: Path):
    """Counts, types and hashes as metadata.yaml says them, every payload as it was, and the run still with it."""
    hydrotwin_here("export", str(recorded.path), "--rosbag2", "-o", "bag", cwd=tmp_path)
    store = get_typestore(Stores.EMPTY)
    with Reader(tmp_path / "bag") as bag:
        counts = {connection.topic.removeprefix("/rig/"): connection.msgcount for connection in bag.connections}
        assert counts == recorded.counts
        assert bag.message_count == len(recorded.entries)
        for connection in bag.connections:
            store.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
            assert store.hash_rihs01(connection.msgtype) == connection.digest
        for topic in counts:
            found = list(bag.messages([c for c in bag.connections if c.topic == f"/rig/{topic}"]))
            assert [(time, data) for _, time, data in found] == [(e.log_time, e.data) for e in recorded.of(topic)]
            for connection, _, data in found[:1]:
                store.deserialize_cdr(data, connection.msgtype)
    (file,) = (tmp_path / "bag").glob("*.mcap")
    assert read(file).metadata == recorded.metadata
    assert (
        "is there already"
        in hydrotwin_here("export", str(recorded.path), "--rosbag2", "-o", "bag", cwd=tmp_path).stderr
    )


def test_what_an_export_cannot_do_is_told_in_one_sentence(recorded: Recording, tmp_path: Path, monkeypatch):
    with pytest.raises(UsageError, match=r"ends in \.mf4"):
        export(recorded, ["measurement"], "mdf", tmp_path / "run.dat")
    with pytest.raises(UsageError, match="nothing in it"):
        export(recorded, ["said"], "rosbag2", tmp_path / "bag")
    monkeypatch.setitem(sys.modules, "asammdf", None)
    with pytest.raises(UsageError, match=r"^MDF needs asammdf: pip install 'hydrotwin\[logs\]'$"):
        export(recorded, list(TOPICS), "mdf", tmp_path / "run.mf4")
