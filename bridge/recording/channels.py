"""The channels of a file by their number there: which topic, of which type."""

from collections.abc import Iterable
from typing import Any, NamedTuple

from mcap.records import Channel, Schema

from bridge.wire.messages import TOPICS

ENCODING = "cdr"


class ChannelFacts(NamedTuple):
    """What a file says of a channel."""

    key: str  # in full
    type: str
    encoding: str
    definition: str  # `.msg` text, or whatever the schema is


class Channels:
    """The channels and types that a file describes; what it says first of a number holds."""

    def __init__(self, described: Iterable[Any] = ()) -> None:
        self.topics: dict[int, str] = {}
        self.channels: dict[int, Channel] = {}
        self.schemas: dict[int, Schema] = {}
        for record in described:
            self.add(record)

    def add(self, record: Any) -> None:
        """Take note of a channel or a type; of other records nothing."""
        if isinstance(record, Schema):
            self.schemas.setdefault(record.id, record)
        elif isinstance(record, Channel) and record.id not in self.channels:
            self.channels[record.id] = record
            self.topics[record.id] = self._name(record)

    def _name(self, channel: Channel) -> str:
        """The topic below the rig's name if it is one of ours, by its type too; else its name in full."""
        name, schema = _below_rig(channel.topic), self.schemas.get(channel.schema_id)
        foreign = schema is not None and name in TOPICS and schema.name != TOPICS[name].type
        return channel.topic if foreign or channel.message_encoding != ENCODING else name

    def facts(self) -> dict[str, ChannelFacts]:
        """What is known of each topic."""
        return {self.topics[number]: self._facts(channel) for number, channel in self.channels.items()}

    def _facts(self, channel: Channel) -> ChannelFacts:
        schema = self.schemas.get(channel.schema_id)
        name, text = (schema.name, schema.data.decode(errors="replace")) if schema else ("", "")
        return ChannelFacts(channel.topic, name, channel.message_encoding, text)


def _below_rig(topic: str) -> str:
    """The topic's name without the rig's, which may have slashes itself."""
    return next((name for name in sorted(TOPICS, key=len, reverse=True) if topic.endswith(f"/{name}")), topic)
