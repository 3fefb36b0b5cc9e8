"""Messages as bytes and back: CDR by `rosbags`, whose classes and serialisers are made of the texts in `messages`.

Making them takes tenths of a second, so whoever only lists or refuses does not import this module.
"""

import struct
from collections.abc import Callable
from functools import cache
from operator import attrgetter
from typing import Any, NamedTuple

from rosbags.serde import SerdeError
from rosbags.typesys import get_types_from_msg
from rosbags.typesys.store import Typestore

from bridge.wire.channels import Layout, text_of
from bridge.wire.messages import (
    PACKAGE,
    TEXTS,
    TOPICS,
    VARYING,
    field_names,
    flat_size,
    struct_format,
)

EMPTY = "uint8 structure_needs_at_least_one_member"  # what ROS 2 sends of a message without fields


def _store() -> Typestore:
    store, types = Typestore(), {}
    for name, text in TEXTS.items():
        types |= get_types_from_msg(text or EMPTY, name)
    store.register(types)
    return store


STORE = _store()


def ready(*topics: str) -> None:
    """Make the serialisers of some topics now: at their first use would be in the middle of a tick."""
    for topic in topics or TOPICS:
        STORE.get_msgdef(TOPICS[topic].type)


def _own(name: str) -> Any:
    return STORE.types[f"{PACKAGE}/{name}"]


Measurement: Any = _own("Measurement")
ValveCommand: Any = _own("ValveCommand")
Reference: Any = _own("Reference")
PlantState: Any = _own("PlantState")
LineProfile: Any = _own("LineProfile")
Residual: Any = _own("Residual")
Estimate: Any = _own("Estimate")
Innovation: Any = _own("Innovation")
Health: Any = _own("Health")
LoopTiming: Any = _own("LoopTiming")
Event: Any = _own("Event")
Signals: Any = _own("Signals")
Status: Any = _own("Status")
JointState: Any = STORE.types["sensor_msgs/msg/JointState"]
FluidPressure: Any = STORE.types["sensor_msgs/msg/FluidPressure"]
Header: Any = STORE.types["std_msgs/msg/Header"]
Time: Any = STORE.types["builtin_interfaces/msg/Time"]


class Channels(NamedTuple):
    """A message of further channels; which they are the scenario says."""

    run_id: int
    sequence: int
    tick: int
    stamp: int
    values: tuple[float, ...]
    __msgtype__ = VARYING


CHANNELS_HEAD = struct.Struct(struct_format(VARYING) or "")

HEADER = b"\x00\x01\x00\x00"  # of CDR, little endian


@cache
def _flat(kind: str) -> tuple[struct.Struct, Callable[[Any], tuple[Any, ...]]] | None:
    """How a flat message is packed, and its fields in order; None for others."""
    layout = struct_format(kind)
    return None if layout is None else (struct.Struct(f"<4s{layout[3:]}"), attrgetter(*field_names(kind)))


def encode(message: Any) -> bytes:
    """CDR, little endian, with its 4-byte header. A flat message is its `struct`: five times quicker."""
    kind = message.__msgtype__
    if kind == VARYING:
        return struct.pack(f"<4sQQQq{len(message.values)}d", HEADER, *message[:-1], *message.values)
    flat = _flat(kind)
    if flat is None:
        return bytes(STORE.serialize_cdr(message, kind))
    layout, fields = flat
    return layout.pack(HEADER, *fields(message))


def decode(payload: bytes, topic: str) -> Any:
    """The message that a payload on a topic holds. Raises ValueError when it is not one."""
    kind = TOPICS[topic].type
    if kind == VARYING:
        return _channels(payload)
    size = flat_size(kind)
    if size is not None and len(payload) != size:
        raise ValueError(f"not a {kind}: {len(payload)} bytes, expected {size}")
    try:
        message: Any = STORE.deserialize_cdr(payload, kind)
    except (SerdeError, UnicodeDecodeError) as error:
        raise ValueError(f"not a {kind}: {len(payload)} bytes that do not decode") from error
    if topic == "signals" and not len(message.names) == len(message.units) == len(message.values):
        raise ValueError(f"not a {kind}: its lists of names, units and values differ in length")
    return message


def _channels(payload: bytes) -> Channels:
    number, rest = divmod(len(payload) - CHANNELS_HEAD.size, 8)
    if number < 1 or rest:
        raise ValueError(f"not a {VARYING}: {len(payload)} bytes, expected {CHANNELS_HEAD.size} and 8 per channel")
    run_id, sequence, tick, stamp = CHANNELS_HEAD.unpack_from(payload)
    return Channels(run_id, sequence, tick, stamp, struct.unpack_from(f"<{number}d", payload, CHANNELS_HEAD.size))


def channels_hash(layout: Layout) -> str:
    """The ROS 2 hash of a run's message of further channels."""
    store = Typestore()
    store.register(get_types_from_msg(text_of(layout), VARYING))
    return store.hash_rihs01(VARYING)


def type_hash(kind: str) -> str:
    """The ROS 2 hash of a type (RIHS01)."""
    return STORE.hash_rihs01(kind)
