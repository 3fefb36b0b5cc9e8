"""How rmw_zenoh names things on Zenoh: keys of topics, liveliness tokens of nodes and endpoints, attachments.

After its design document (github.com/ros2/rmw_zenoh, docs/design.md) and what its nodes send.
"""

import hashlib
import struct
from enum import StrEnum
from typing import NamedTuple

ADMIN = "@ros2_lv"
NONE = "%"  # no enclave, the namespace /
QOS = "::,10:,:,:,,"  # reliable, volatile, the last 10 kept: what differs from the defaults stands there, here nothing
ATTACHED = struct.Struct("<qqB16s")  # sequence, source time [ns], length of the identity, identity
IDENTITY = 16  # bytes


class Kind(StrEnum):
    """What a token stands for."""

    NODE = "NN"
    PUBLISHER = "MP"
    SUBSCRIPTION = "MS"


class Type(NamedTuple):
    """A message type as ROS knows it."""

    name: str  # std_msgs/msg/String
    hash: str  # RIHS01_...

    @property
    def path(self) -> str:
        """Name and hash in a key."""
        package, kind, name = self.name.split("/")
        return f"{package}::{kind}::dds_::{name}_/{self.hash}"


class Node(NamedTuple):
    """One node of a session."""

    domain: int
    session: str  # Zenoh's id of it
    name: str

    def token(self) -> str:
        """The key of its liveliness."""
        return f"{ADMIN}/{self.domain}/{self.session}/0/0/{Kind.NODE}/{NONE}/{NONE}/{self.name}"

    def endpoint(self, kind: Kind, number: int, topic: str, type_: Type) -> str:
        """The key of the liveliness of a publisher or subscription; its number is its own in the session."""
        who = f"{self.session}/0/{number}/{kind}/{NONE}/{NONE}/{self.name}"
        return f"{ADMIN}/{self.domain}/{who}/{mangled(topic)}/{type_.path}/{QOS}"


def mangled(topic: str) -> str:
    """A topic's full name, leading slash included, as one part of a key."""
    return f"/{topic}".replace("/", "%")


def key(domain: int, topic: str, type_: Type) -> str:
    """Where the messages of a topic travel; the topic without its leading slash."""
    return f"{domain}/{topic}/{type_.path}"


def publishers_of(domain: int, topic: str) -> str:
    """The tokens of everybody who publishes a topic."""
    return f"{ADMIN}/{domain}/*/*/*/{Kind.PUBLISHER}/*/*/*/{mangled(topic)}/**"


def identity(token: str) -> bytes:
    """The identity of a publisher, from its token: the same whenever it is asked for."""
    return hashlib.blake2b(token.encode(), digest_size=IDENTITY).digest()


def attached(sequence: int, time_ns: int, who: bytes) -> bytes:
    """What goes with a message."""
    return ATTACHED.pack(sequence, time_ns, IDENTITY, who)
