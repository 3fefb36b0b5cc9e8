"""The types of ROS 2 that a rig's topics have, with their hashes, and those of the bridge's own topics."""

from typing import Any

from rosbags.typesys import get_types_from_msg
from rosbags.typesys.store import Typestore

from bridge.connect.ros.naming import Type
from bridge.wire.channels import Layout
from bridge.wire.codec import channels_hash, type_hash
from bridge.wire.messages import CHANNELS_TOPIC, STANDARD_MESSAGES, TOPICS

TIME = "builtin_interfaces/msg/Time"
CLOCK, STRING = "rosgraph_msgs/msg/Clock", "std_msgs/msg/String"
BRIDGE_MESSAGES = {CLOCK: "builtin_interfaces/Time clock\n", STRING: "string data\n"}


def _store() -> Typestore:
    store = Typestore()
    for name, text in {TIME: STANDARD_MESSAGES[TIME], **BRIDGE_MESSAGES}.items():
        store.register(get_types_from_msg(text, name))
    return store


STORE = _store()


def type_of(topic: str, layout: Layout) -> Type:
    """The type of a rig's topic; that of the further channels follows from the run's."""
    kind = TOPICS[topic].type
    return Type(kind, channels_hash(layout) if topic == CHANNELS_TOPIC else type_hash(kind))


def bridge_type(name: str) -> Type:
    """A type of the bridge's own topics."""
    return Type(name, STORE.hash_rihs01(name))


def clock(time_ns: int) -> bytes:
    """The message of `/clock`."""
    time = STORE.types[TIME](sec=time_ns // 10**9, nanosec=time_ns % 10**9)
    return bytes(STORE.serialize_cdr(STORE.types[CLOCK](clock=time), CLOCK))


def string(text: str) -> bytes:
    """A text as a message."""
    return bytes(STORE.serialize_cdr(STORE.types[STRING](data=text), STRING))


def text_of(payload: bytes) -> str:
    """The text in such a message. Raises ValueError."""
    from rosbags.serde import SerdeError

    try:
        message: Any = STORE.deserialize_cdr(payload, STRING)
    except (SerdeError, UnicodeDecodeError) as error:
        raise ValueError(f"not a {STRING}: {error}") from None
    return str(message.data)
