"""The topics of a run as Foxglove's channels: the CDR of the wire as it is, with the schemas of a recording."""

from typing import TYPE_CHECKING, Any

from bridge.scenario import Scenario
from bridge.scenario.channels import layout_of
from bridge.wire.channels import text_of
from bridge.wire.messages import CHANNELS_TOPIC, TOPICS, definition

if TYPE_CHECKING:
    from bridge.recording.entries import Entry

HEARD = tuple(topic.name for topic in TOPICS.values() if topic.publisher != "anybody")


class Channels:
    """The channels of one run."""

    def __init__(self, rig: str, scenario: Scenario, context: Any) -> None:
        self._rig = rig
        self._context = context
        self._layout = layout_of(scenario)
        # all at once, also those that most runs do not have: a client has to subscribe before the first message
        self._channels = {name: self._made(name) for name in HEARD if name != CHANNELS_TOPIC or self._layout}

    def log(self, entry: "Entry") -> None:
        """Pass a message on, at its simulated time."""
        if entry.topic in self._channels:
            self._channels[entry.topic].log(entry.data, log_time=entry.log_time)

    def close(self) -> None:
        """Take them all away."""
        for channel in self._channels.values():
            channel.close()

    def _made(self, name: str) -> Any:
        from foxglove import Channel, Schema

        kind = TOPICS[name].type
        text = text_of(self._layout) if name == CHANNELS_TOPIC else definition(kind)
        schema = Schema(name=kind, encoding="ros2msg", data=text.encode())
        return Channel(f"{self._rig}/{name}", schema=schema, message_encoding="cdr", context=self._context)
