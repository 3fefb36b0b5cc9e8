"""Bags: MCAP of any robot or logger (ROS 2 in CDR, or JSON), rosbag2 folders, and their SQLite files.

Each field of numbers is a column, TOPIC.FIELD; its rows have the times at which the messages were logged, or those of
`[time] column = "header.stamp"`.
"""

import json
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bridge.errors import UsageError
from bridge.recording.logs.bag_folder import files_of_bag
from bridge.recording.logs.columns_of import column
from bridge.recording.logs.flat import Nanoseconds, flat
from bridge.recording.logs.limits import MOST_CELLS, refuse_large, size_of
from bridge.recording.logs.reading import Reading
from bridge.recording.logs.table import Column, Table

Decode = Callable[[bytes], Any]


class Channel(NamedTuple):
    """What a bag says of a topic."""

    type: str
    encoding: str
    definition: str


class Message(NamedTuple):
    """One message of a bag."""

    topic: str
    stamp: int  # [ns], of the logger
    data: bytes


def read_folder(path: Path, reading: Reading) -> Table:
    """A rosbag2 folder: all its files. Raises UsageError for another folder."""
    files = files_of_bag(path)
    bags = [_mcap(file) if file.suffix == ".mcap" else _sqlite(file) for file in files]
    channels = {topic: channel for known, _ in reversed(bags) for topic, channel in known.items()}
    return _table(path, channels, [message for _, messages in bags for message in messages], "rosbag2")


def read_mcap(path: Path, reading: Reading) -> Table:
    """An MCAP file."""
    return _table(path, *_mcap(path), "MCAP")


def read_sqlite(path: Path, reading: Reading) -> Table:
    """A rosbag2 file of SQLite."""
    return _table(path, *_sqlite(path), "rosbag2, SQLite")


def _mcap(path: Path) -> tuple[dict[str, Channel], list[Message]]:
    from bridge.recording.reader import read

    size_of(path)
    found = read(path)
    channels = {t: Channel(facts.type, facts.encoding, facts.definition) for t, facts in found.channels.items()}
    return channels, [Message(entry.topic, entry.log_time, entry.data) for entry in found.entries]


def _sqlite(path: Path) -> tuple[dict[str, Channel], list[Message]]:
    from rosbags.rosbag2.errors import ReaderError
    from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

    size_of(path)
    reader = Sqlite3Reader(path)
    try:
        reader.open()
        known = reader.connections
        channels = {one.topic: Channel(one.msgtype, "cdr", one.msgdef.data) for one in known}
        messages = [Message(one.topic, stamp, bytes(data)) for one, stamp, data in reader.messages(known)]
        reader.close()
    except (ReaderError, ValueError, KeyError, OSError) as error:
        raise UsageError(f"{path}: is SQLite, but not a bag of ROS 2 that can be read ({error!s:.100})") from None
    return channels, messages


def _table(path: Path, channels: dict[str, Channel], messages: list[Message], form: str) -> Table:
    by_topic: dict[str, list[Message]] = {}
    for message in messages:
        by_topic.setdefault(message.topic, []).append(message)
    found: dict[str, Column] = {}
    left: list[str] = []
    notes: list[str] = []
    for topic, own in by_topic.items():
        decode = _decoder(channels.get(topic, Channel("", "", "")))
        if decode is None:
            left.append(topic)
            continue
        rows, stamps = _rows(own, decode)
        if unread := len(own) - len(rows):
            notes.append(f"{topic}: {unread} of {len(own)} messages are not what their channel says, and are left out")
        found |= {made.name: made for made in _columns(path, topic, rows, stamps)}
    if not found:
        raise UsageError(f"{path}: holds no message with numbers that can be read (CDR of ROS 2, or JSON)")
    if sum(len(one.values) for one in found.values()) > MOST_CELLS:
        raise UsageError(f"{path}: has more than {MOST_CELLS} numbers; a log may have as many: leave topics out")
    encodings = ", ".join(sorted({channels[topic].encoding for topic in by_topic if topic in channels}))
    if left:
        notes.append(f"topics left out, since their encoding or type is not known here: {', '.join(left[:5])}")
    return Table(f"{form}, {encodings}", found, tuple(notes))


def _rows(messages: Iterable[Message], decode: Decode) -> tuple[list[dict[str, Any]], list[int]]:
    """The numbers of each message that can be read, by name, and its stamp [ns]."""
    rows, stamps = [], []
    for message in messages:
        try:
            rows.append(dict(flat(decode(message.data))))
        except Exception:  # of many kinds: a payload is not what its channel says
            continue
        stamps.append(message.stamp)
    return rows, stamps


def _columns(path: Path, topic: str, rows: list[dict[str, Any]], stamps: list[int]) -> Iterator[Column]:
    """Every field of a topic that has numbers, with NaN where a message lacks it."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    refuse_large(path, len(rows), len(names))
    clock = np.array(stamps, np.int64)
    for name in names:
        values = [row.get(name) for row in rows]
        unit = "ns" if any(isinstance(value, Nanoseconds) for value in values) else ""
        made = column(f"{topic}.{name}" if name else topic, _array(values), unit, clock)
        if made is not None:
            yield made


def _array(values: list[Any]) -> Any:
    if all(isinstance(value, int) for value in values):
        try:
            return np.array(values, np.int64)
        except OverflowError:
            return np.array(values, np.float64)
    if any(isinstance(value, str) for value in values):
        return np.array(["" if value is None else str(value) for value in values], np.str_)
    return np.array([np.nan if value is None else value for value in values], np.float64)


def _decoder(channel: Channel) -> Decode | None:
    """How a topic's payload is read; None where that is not known."""
    if channel.encoding == "json":
        return json.loads
    return _cdr(channel.type, channel.definition) if channel.encoding == "cdr" else None


def _cdr(kind: str, definition: str) -> Decode | None:
    """By the definition in the file, else by that of ROS 2 itself."""
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
    from rosbags.typesys.store import Typestore

    for parse in (lambda: get_types_from_msg(definition, kind), lambda: get_types_from_idl(definition)):
        store = Typestore()
        try:
            store.register(parse())
            store.get_msgdef(kind)
        except Exception:  # not a definition in this language
            continue
        return lambda data, store=store: store.deserialize_cdr(data, kind)
    store = get_typestore(Stores.ROS2_HUMBLE)
    return (lambda data: store.deserialize_cdr(data, kind)) if kind in store.types else None
