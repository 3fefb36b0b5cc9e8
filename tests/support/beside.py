"""A follower beside a loop in process."""

from collections.abc import Sequence

from bridge.loop.follower import FollowerSide
from bridge.wire.messages import Outgoing

ORDER = {"command": 0, "event": 1}  # scans come after what they are of


def hand(messages: Sequence[Outgoing], side: FollowerSide) -> None:
    """An instant of the loop to the follower."""
    for message in sorted(messages, key=lambda m: ORDER.get(m.topic, 2)):
        if message.topic == "command":
            side.take(message.message)
        elif message.topic == "event":
            side.heed(message.message)
        elif message.topic == "measurement":
            side.hear(message.message)
