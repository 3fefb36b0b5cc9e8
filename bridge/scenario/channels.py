"""The further channels of a scenario's card: which there may be, and which of them it has chosen."""

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from bridge.errors import nearest
from bridge.scenario.fitted import of_drive
from bridge.scenario.units import SHOWN, shown
from bridge.wire.channels import ChannelField, Layout
from twin.kept import sensors
from twin.topology import Sensor

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

LISTED = "`hydrotwin messages --scenario NAME` says what each is"


class Row(NamedTuple):
    """What a channel may read, SI."""

    name: str
    unit: str
    low: float  # ends of its range
    high: float
    reads: str
    place: int | None  # among those that are chosen

    def in_words(self) -> tuple[str, ...]:
        """The same for people, in the units that they read."""
        factor, unit = shown(self.unit, "" if self.unit in SHOWN else self.unit)
        ends = (f"{end * factor:.6g}" for end in (self.low, self.high))
        return self.name, unit, *ends, self.reads, "" if self.place is None else str(self.place + 1)


def rows_of(scenario: "Scenario") -> list[Row]:
    """All that the channels of the scenario's drive may read."""
    places, rig = {name: place for place, name in enumerate(scenario.daq.channels)}, scenario.rig_values()
    return [
        Row(name, sensor.unit, *sensor.ends(scenario.daq), of_drive(sensor.note.strip(" ,"), rig), places.get(name))
        for name, sensor in known(scenario).items()
    ]


def known(scenario: "Scenario") -> dict[str, Sensor]:
    """All that the channels of the scenario's drive may read."""
    return sensors(scenario.rig_values())


def chosen(scenario: "Scenario") -> dict[str, Sensor]:
    """What the further channels read, in their order."""
    found = known(scenario) if scenario.daq.channels else {}
    return {name: found[name] for name in scenario.daq.channels}


def layout_of(scenario: "Scenario") -> Layout:
    """The fields of the scenario's message of further channels; empty where it has none."""
    return tuple(ChannelField(name, sensor.unit, sensor.note) for name, sensor in chosen(scenario).items())


def refuse_unknown(names: list[str], rig: Mapping[str, Mapping[str, Any]]) -> None:
    """Raises ValueError for channels that a drive does not have, and for one that is named twice."""
    valid = sensors(rig)
    for name in names:
        if name not in valid:
            raise ValueError(f"daq.channels: {name!r} is not a channel of this drive{nearest(name, valid)}; {LISTED}")
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise ValueError(f"daq.channels: {twice[0]!r} is named twice; name each channel once")
