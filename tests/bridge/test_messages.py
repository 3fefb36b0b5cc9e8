"""The wire: flat messages are a `struct` away, and noise is told from messages."""

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from bridge.wire.codec import STORE, Measurement, ValveCommand, decode, encode, type_hash
from bridge.wire.definitions import LOOP_MESSAGES, STANDARD_MESSAGES
from bridge.wire.messages import (
    TOPICS,
    definition,
    field_names,
    flat_size,
    struct_format,
)

U64, I64, F64 = st.integers(0, 2**64 - 1), st.integers(-(2**63), 2**63 - 1), st.floats(width=64)


def test_every_loop_message_is_flat_and_of_eight_byte_fields():
    flat = {topic.type for topic in TOPICS.values() if topic.type.rpartition("/")[2] in LOOP_MESSAGES}
    assert len(flat) == len(LOOP_MESSAGES)
    for kind in flat:
        assert flat_size(kind) == 4 + 8 * len(field_names(kind)) == struct.calcsize(struct_format(kind) or "")


@given(st.tuples(U64, U64, U64, I64, F64, F64, F64, F64, F64))
def test_a_measurement_is_its_struct(values):
    """The maintained serialiser and two lines of `struct` write the same bytes."""
    layout = struct_format("hydrotwin_msgs/msg/Measurement")
    assert layout == "<4xQQQqddddd"
    by_hand = b"\x00\x01\x00\x00" + struct.pack("<QQQqddddd", *values)
    assert encode(Measurement(*values)) == by_hand
    assert struct.pack("<9Q", *struct.unpack("<9Q", by_hand[4:])) == by_hand[4:]


@pytest.mark.parametrize("name", LOOP_MESSAGES)
def test_the_quick_way_writes_what_the_maintained_serialiser_writes(name):
    kind = f"hydrotwin_msgs/msg/{name}"
    values = {"Q": 2**63 + 5, "q": -7, "d": math.pi}
    message = STORE.types[kind](*(values[code] for code in (struct_format(kind) or "")[3:]))
    assert encode(message) == bytes(STORE.serialize_cdr(message, kind))


@given(st.tuples(U64, U64, U64, I64, I64, st.floats(-1, 1)))
def test_a_command_by_struct_is_read(values):
    command = decode(b"\x00\x01\x00\x00" + struct.pack("<QQQqqd", *values), "command")
    assert command == ValveCommand(*values)


@pytest.mark.parametrize("payload", [b"", b"\x00", b"\xff" * 52, b"\x00\x01\x00\x00" + b"\x00" * 47, b"\x00" * 500])
def test_what_is_no_command_is_told_so(payload):
    with pytest.raises(ValueError, match="ValveCommand"):
        decode(payload, "command")


@given(st.binary(max_size=200))
def test_no_payload_whatever_brings_the_reader_down(payload):
    for topic in TOPICS:
        try:
            decode(payload, topic)
        except ValueError:
            continue


@pytest.mark.parametrize("kind", sorted({topic.type for topic in TOPICS.values()}))
def test_schemas_are_those_of_the_maintained_library(kind):
    assert definition(kind) == STORE.generate_msgdef(kind, ros_version=2)[0]


@pytest.mark.parametrize("kind", STANDARD_MESSAGES)
def test_standard_messages_are_those_of_ros(kind):
    assert type_hash(kind) == get_typestore(Stores.ROS2_JAZZY).hash_rihs01(kind)
