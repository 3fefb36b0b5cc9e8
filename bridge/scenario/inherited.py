"""Channels that a scenario takes over from another one, whose drive has a part that its own drive does not have."""

from collections.abc import Collection
from typing import Any

from twin.kept import channel_name, sensors
from twin.rig import values


def without_unfitted(data: dict[str, Any], before: dict[str, Any], given: bool) -> dict[str, Any]:
    """Plain data, without those inherited channels of the card that only the drive of before has.

    given: the channels are the scenario's own. Those, and names that no drive has, stay, to be refused.
    """
    daq = data.get("daq")
    channels = daq.get("channels") if isinstance(daq, dict) else None
    if given or not isinstance(channels, list):
        return data
    gone = _sensors(before) - _sensors(data)
    kept = [name for name in channels if not isinstance(name, str) or channel_name(name) not in gone]
    return data if len(kept) == len(channels) else data | {"daq": {**data["daq"], "channels": kept}}


def gives_channels(changes: Collection[str]) -> bool:
    """Is there a change of the channels of the card?"""
    return any(change.partition("=")[0].strip() == "daq.channels" for change in changes)


def _sensors(data: dict[str, Any]) -> set[str]:
    """Channels of the drive that plain data describe, which need not be right."""
    rig = data.get("rig")
    parts = rig.items() if isinstance(rig, dict) else ()
    return set(sensors(values({name: part for name, part in parts if isinstance(part, dict)})))
