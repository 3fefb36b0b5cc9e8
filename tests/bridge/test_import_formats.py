"""Logs in MATLAB's files, Parquet, MDF and bags of ROS 2 become the same recording, or are refused in one sentence."""

import json
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore
from scipy.io import savemat

from bridge.errors import UsageError
from bridge.recording.imported import facts
from bridge.recording.logs import limits, mat_file
from bridge.recording.logs.bag_folder import files_of_bag
from bridge.recording.logs.formats import read_log
from bridge.recording.logs.measured import measured
from bridge.recording.logs.reading import Reading
from tests.support.logs import BAR, MM, ROWS, TIME, VOLTS, assert_exact, made_of

BEGIN = 1_767_225_600_000_000_000  # [ns], 2026-01-01
STAMPS = BEGIN + np.arange(ROWS) * 1_000_000
SECONDS = '[time]\ncolumn = "t"\nunit = "s"'


def refused(path: Path, *columns: str) -> str:
    with pytest.raises(UsageError) as found:
        made_of(path, *(columns or ("u", "x", "p")), time=SECONDS)
    assert "\n" not in str(found.value)
    return str(found.value)


def test_matlab_5_vectors(tmp_path):
    savemat(tmp_path / "a.mat", {"t": TIME, "u": VOLTS, "x": MM, "p": BAR}, do_compression=True)
    made = made_of(tmp_path / "a.mat", "u", "x", "p", SECONDS)
    assert_exact(made)
    assert facts(made.recording)["form"] == "MATLAB, version 5 to 7"


def test_matlab_5_structures_as_simulink_logs_them(tmp_path):
    signals = {"values": np.column_stack([VOLTS, MM, BAR]), "label": "u, x, p"}
    savemat(tmp_path / "a.mat", {"log": {"time": TIME, "signals": signals}})
    column = "log.signals.values[{}]"
    time = '[time]\ncolumn = "log.time"\nunit = "s"'
    u, x, p = (column.format(i) for i in (1, 2, 3))
    assert_exact(made_of(tmp_path / "a.mat", u, x, p, time))


def test_matlab_7_3(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.mat", "w", userblock_size=512) as file:
        for name, values in (("t", TIME), ("u", VOLTS), ("x", MM), ("p", BAR)):
            kept = file.create_dataset(name, data=values.reshape(1, -1), compression="gzip")  # a column there
            kept.attrs["MATLAB_class"] = np.bytes_("double")
        word = file.create_dataset("remark", data=np.array([[82, 105, 103]], np.uint16))
        word.attrs["MATLAB_class"] = np.bytes_("char")
    made = made_of(tmp_path / "a.mat", "u", "x", "p", SECONDS)
    assert_exact(made)
    assert facts(made.recording)["form"] == "MATLAB, version 7.3"


def test_hdf5_reads_nothing_outside_the_file(tmp_path):
    """Links to other files, and data kept in other files, are not followed."""
    h5py = pytest.importorskip("h5py")
    (tmp_path / "secret").write_bytes(b"\x01" * 80)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = np.arange(10.0)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"] = np.arange(10.0)
        file["linked"] = h5py.ExternalLink("other.h5", "/x")
        file.create_dataset("outside", (10,), "f8", external=[(str(tmp_path / "secret"), 0, 80)])
    assert list(read_log(tmp_path / "a.h5", Reading()).columns) == ["t"]


def test_parquet_with_units_and_time_stamps(tmp_path):
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    stamps = pyarrow.array(STAMPS, pyarrow.timestamp("ns", "Europe/Berlin"))
    table = pyarrow.table({"when": stamps, "u": VOLTS, "x [mm]": MM, "p": BAR, "state": ["on"] * ROWS})
    parquet.write_table(table, tmp_path / "a.parquet")
    assert_exact(made_of(tmp_path / "a.parquet", "u", "x [mm]", "p", '[time]\ncolumn = "when"'))


def test_mdf_4_with_groups_of_their_own_times(tmp_path):
    """Volts at 100 Hz, held between; the others at 1 kHz in another group: no map of times is needed."""
    asammdf = pytest.importorskip("asammdf")
    signal = asammdf.Signal
    file = asammdf.MDF(version="4.10")
    file.append([signal(MM, TIME, name="x", unit="mm"), signal(BAR, TIME, name="p", unit="bar")])
    slow = slice(None, None, 10)
    file.append(
        [signal(VOLTS[slow], TIME[slow], name="u", unit="V"), signal(MM[slow], TIME[slow], name="x", unit="mm")]
    )
    file.save(tmp_path / "a.mf4", compression=2)
    file.close()
    table = read_log(tmp_path / "a.mf4", Reading())
    assert {name: column.unit for name, column in table.columns.items()} == {
        "x": "mm",
        "p": "bar",
        "u": "V",
        "group2.x": "mm",
    }
    found = measured(made_of(tmp_path / "a.mf4", "u", "x", "p").recording)
    assert np.abs(found.signals["position"] - MM * 1e-3).max() <= 1e-12
    assert np.abs(found.command[:391] - VOLTS[:391] / 10.0).max() <= 1e-12
    assert np.isnan(found.command[391:]).all()  # behind the last row nothing is known


@pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_rosbag2_of_another_project(tmp_path, storage):
    """Joints in one topic, two floats in others, as some robot logs them; folder, and file alone."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    joint, number, header, moment = (
        store.types[name]
        for name in (
            "sensor_msgs/msg/JointState",
            "std_msgs/msg/Float64",
            "std_msgs/msg/Header",
            "builtin_interfaces/msg/Time",
        )
    )
    names, none = ["swing", "boom"], np.zeros(0)
    with BagWriter(tmp_path / "bag", version=9, storage_plugin=storage) as bag:
        topics = {
            topic: bag.add_connection(topic, kind, typestore=store)
            for topic, kind in (
                ("/joint_states", joint.__msgtype__),
                ("/valve/u", number.__msgtype__),
                ("/p_cap", number.__msgtype__),
            )
        }
        for k, stamp in enumerate(STAMPS.tolist()):
            when = header(stamp=moment(sec=stamp // 10**9, nanosec=stamp % 10**9), frame_id="")
            state = joint(header=when, name=names, position=np.array([0.5, MM[k]]), velocity=none, effort=none)
            late = stamp + (k * 7919) % 400_000  # [ns]: the logger's own time jitters
            for topic, message in zip(topics, (state, number(VOLTS[k]), number(BAR[k])), strict=True):
                at = late if topic == "/joint_states" else stamp
                bag.write(topics[topic], at, store.serialize_cdr(message, message.__msgtype__))
    columns = "/valve/u.data", "/joint_states.position[boom]", "/p_cap.data"
    found = read_log(tmp_path / "bag", Reading()).columns
    assert (found["/joint_states.position[boom]"].values == MM).all()
    assert (found["/joint_states.header.stamp"].whole == STAMPS).all()
    file = next(path for path in (tmp_path / "bag").iterdir() if path.suffix in (".db3", ".mcap"))
    assert list(read_log(file, Reading()).columns) == list(found)
    rows = measured(made_of(tmp_path / "bag", *columns).recording)
    assert np.abs(rows.signals["position"][1:-1] - MM[1:-1] * 1e-3).max() < 4e-4 * 0.377 * 2.0  # 0.4 ms at 0.377 m/s
    assert np.abs(rows.command[1:-1] - VOLTS[1:-1] / 10.0).max() == 0.0


def test_mcap_of_json_with_the_stamp_of_the_message(tmp_path):
    """Another logger's JSON; the times are those in the messages, not those of the logger."""
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("rig", "jsonschema", b"{}")
        channel = writer.register_channel("rig", "json", schema)
        for k in range(ROWS):
            stamp = int(STAMPS[k])
            body = {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}, "u": VOLTS[k], "x": MM[k], "p": BAR[k]}
            writer.add_message(channel, stamp + 250_000 * (k % 2), json.dumps(body).encode(), stamp, k)
        writer.finish()
    assert_exact(made_of(tmp_path / "a.mcap", "rig.u", "rig.x", "rig.p", '[time]\ncolumn = "stamp"'))


def test_messages_that_cannot_be_read_are_counted_and_told(tmp_path):
    """Two of twelve are cut short; nothing is made up in their place."""
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("rig", "json", writer.register_schema("rig", "jsonschema", b"{}"))
        for k in range(12):
            body = json.dumps({"x": float(k)}).encode()
            writer.add_message(channel, k * 10**6, body[:-3] if k in (4, 9) else body, k * 10**6, k)
        writer.finish()
    table = read_log(tmp_path / "a.mcap", Reading())
    assert len(table.columns["rig.x"].values) == 10
    assert [note for note in table.notes if note.startswith("rig: 2 of 12 messages")]


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [  # three of them need what may not be installed
        ("a.xlsx", b"PK\x03\x04" + bytes(60), "spreadsheet"),
        ("a.bag", b"#ROSBAG V2.0\n", "bag of ROS 1"),
        ("a.mat", b"MATLAB 5.0 MAT-file" + b" " * 105 + b"\x00\x01IM" + bytes(40), "not a MATLAB file"),
        ("a.parquet", b"PAR1" + bytes(40) + b"PAR1", "Parquet that cannot be read"),
        ("a.db3", b"SQLite format 3\0" + bytes(200), "not a bag"),
        ("a.mcap", b"\x89MCAP0\r\n" + bytes(20), "no message"),
        ("a.mf4", b"MDF     4.10    " + bytes(200), "MDF that cannot be read"),
        ("a.mat", bytes(512) + b"\x89HDF\r\n\x1a\n" + bytes(100), "HDF5 that cannot be read"),
    ],
)
def test_damaged_files_and_those_of_other_kinds(tmp_path, name, content, words):
    for reader, form in (("asammdf", "MDF"), ("h5py", "HDF5"), ("pyarrow", "Parquet")):
        if words.startswith(form):
            pytest.importorskip(reader)
    (tmp_path / name).write_bytes(content)
    assert words in refused(tmp_path / name)


def test_a_folder_that_is_no_bag(tmp_path):
    """Nothing in it is read."""
    assert "without a bag" in refused(tmp_path)
    for name in ("a.mcap", "b_1.mcap"):
        (tmp_path / name).write_bytes(b"not read")
    assert "2 files (a.mcap, b_1.mcap, ...) and without the metadata.yaml" in refused(tmp_path)


def test_the_files_of_a_bag_are_its_parts_or_those_that_its_metadata_lists(tmp_path):
    for name in ("run_0.mcap", "run_1.mcap"):
        (tmp_path / name).touch()
    assert [file.name for file in files_of_bag(tmp_path)] == ["run_0.mcap", "run_1.mcap"]
    (tmp_path / "other.mcap").touch()
    (tmp_path / "metadata.yaml").write_text("info:\n  relative_file_paths:\n    - run_0.mcap\n    - 'run_1.mcap'\n")
    assert [file.name for file in files_of_bag(tmp_path)] == ["run_0.mcap", "run_1.mcap"]


def test_a_bomb_in_a_matlab_file(tmp_path, monkeypatch):
    """30 MB of zeros in 30 kB: what a part unpacks to is counted before scipy unpacks it."""
    for module in (limits, mat_file):
        monkeypatch.setattr(module, "MOST_BYTES", 10**7)
    packed = zlib.compress(struct.pack("<II", 14, 3 * 10**7) + bytes(3 * 10**7), 9)
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    (tmp_path / "a.mat").write_bytes(head + struct.pack("<II", 15, len(packed)) + packed)
    assert "too many bytes" in refused(tmp_path / "a.mat")


def test_objects_in_a_matlab_file_are_left_out(tmp_path):
    held = {"t": TIME, "u": VOLTS, "x": MM, "p": BAR, "cells": np.array([1, "two"], dtype=object), "name": "rig"}
    savemat(tmp_path / "a.mat", held)
    assert_exact(made_of(tmp_path / "a.mat", "u", "x", "p", SECONDS))
    assert "'cells'" in refused(tmp_path / "a.mat", "cells", "x", "p")


def test_columns_of_other_lengths_need_times_of_their_own(tmp_path):
    savemat(tmp_path / "a.mat", {"t": TIME, "u": VOLTS, "x": MM[:300], "p": BAR})
    assert "300 rows, and its times 400" in refused(tmp_path / "a.mat")


@pytest.mark.parametrize(("module", "name"), [("h5py", "a.mat"), ("asammdf", "a.mf4"), ("pyarrow", "a.parquet")])
def test_what_is_not_installed_is_told_in_one_sentence(tmp_path, monkeypatch, module, name):
    begins = {"a.mat": b"\x89HDF\r\n\x1a\n", "a.mf4": b"MDF     ", "a.parquet": b"PAR1"}[name]
    (tmp_path / name).write_bytes(begins + bytes(600))
    monkeypatch.setitem(__import__("sys").modules, module, None)
    assert "pip install 'hydrotwin[" in refused(tmp_path / name)
