"""A recording as a bag of ROS 2: a folder with the messages in MCAP, as they are, and `metadata.yaml` beside them.

The MCAP file is still a recording of ours, with all that it says of its run; topics have the leading slash of ROS.
"""

from collections import Counter
from pathlib import Path
from typing import Any

from rosbags.rosbag2.metadata import dump_qos_v9, parse_qos
from ruamel.yaml import YAML

from bridge.errors import UsageError, writing
from bridge.recording.entries import Entry
from bridge.recording.reader import Recording
from bridge.recording.writer import QOS, RecordingWriter
from bridge.wire.codec import channels_hash, type_hash
from bridge.wire.messages import CHANNELS_TOPIC, TOPICS

VERSION = 9  # of metadata.yaml, that of ROS 2 Jazzy
DISTRIBUTION = "jazzy"


def write_bag(recording: Recording, topics: list[str], folder: Path) -> list[Path]:
    """Write topics as a new bag; its files. Raises UsageError when the folder is there, or nothing is to be written."""
    chosen = [topic for topic in topics if recording.counts.get(topic)]
    entries = [entry for entry in recording.entries if entry.topic in chosen]
    if not entries:
        raise UsageError(f"{recording.path}: there is nothing in it to export")
    if folder.exists():
        raise UsageError(f"{folder}: is there already, and a bag is a new folder; name another one with -o")
    rig = f"/{_rig_of(recording, chosen[0])}"
    with writing(folder / "metadata.yaml") as metadata:
        file = folder / f"{folder.name}_0.mcap"
        _write_messages(recording, entries, chosen, file, rig)
        with metadata.open("w", encoding="utf-8") as stream:
            _yaml().dump(_metadata(recording, entries, chosen, file.name, rig), stream)
    return [file, metadata]


def _yaml() -> YAML:
    """YAML without anchors, one entry a line, in our order: as rosbag2 writes it."""
    yaml = YAML(typ="safe", pure=True)
    yaml.default_flow_style = False
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]
    yaml.representer.ignore_aliases = lambda *_: True
    return yaml


def _rig_of(recording: Recording, topic: str) -> str:
    return recording.channels[topic].key.removesuffix(f"/{topic}").strip("/")


def _write_messages(recording: Recording, entries: list[Entry], topics: list[str], file: Path, rig: str) -> None:
    writer = RecordingWriter(file, rig, topics, channels=recording.layout())
    for name, values in recording.metadata.items():
        writer.metadata(name, values)
    for entry in entries:
        writer.write(*entry)
        writer.flush_by(entry.log_time)
    writer.close()


def _metadata(recording: Recording, entries: list[Entry], topics: list[str], file: str, rig: str) -> dict[str, Any]:
    times = [entry.log_time for entry in entries]
    span = {
        "starting_time": {"nanoseconds_since_epoch": min(times)},
        "duration": {"nanoseconds": max(times) - min(times)},
        "message_count": len(entries),
    }
    counts = Counter(entry.topic for entry in entries)
    return {
        "rosbag2_bagfile_information": {
            "version": VERSION,
            "storage_identifier": "mcap",
            "relative_file_paths": [file],
            **span,
            "topics_with_message_count": [
                {"topic_metadata": _described(recording, topic, rig), "message_count": counts[topic]}
                for topic in topics
            ],
            "compression_format": "",
            "compression_mode": "",
            "files": [{"path": file, **span}],
            "custom_data": None,
            "ros_distro": DISTRIBUTION,
        }
    }


def _described(recording: Recording, topic: str, rig: str) -> dict[str, Any]:
    kind = TOPICS[topic].type
    return {
        "name": f"{rig}/{topic}",
        "type": kind,
        "serialization_format": "cdr",
        "offered_qos_profiles": dump_qos_v9(parse_qos(QOS)),
        "type_description_hash": channels_hash(recording.layout()) if topic == CHANNELS_TOPIC else type_hash(kind),
    }
