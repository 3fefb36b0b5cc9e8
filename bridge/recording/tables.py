"""A channel as a table: one row a message, one column a number, with its unit."""

import json
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any, NamedTuple

import numpy as np

from bridge.recording.reader import Recording
from bridge.recording.signals import comments_in, has_columns, units_in
from bridge.scenario.units import AMBIENT
from bridge.wire.messages import CHANNELS_TOPIC, TOPICS, of_tap
from controller.grid import NS

GAUGE = ("measurement", CHANNELS_TOPIC, "state", "lines")  # topics whose pressures are gauge, and those of the taps


class Column(NamedTuple):
    """One column of a table."""

    name: str
    unit: str  # "" where there is none
    values: Any  # array of numbers, or list of texts
    comment: str = ""  # what the message table says of it

    @property
    def header(self) -> str:
        """Name and unit, as at the head of a column."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def table(recording: Recording, topic: str, absolute: bool = False) -> list[Column]:
    """The columns of a topic, first the time it was recorded at. Raises ValueError for a topic that is not ours.

    absolute: pressures above a vacuum, not gauge.
    """
    if topic not in TOPICS:
        raise ValueError(f"{topic}: a type that is not known here")
    time = np.array([entry.log_time for entry in recording.of(topic)], dtype=np.float64) / NS
    known = units_in(recording, topic)
    if has_columns(topic):
        rest = [Column(name, known.get(name, ""), values) for name, values in recording.columns(topic).items()]
    else:
        rows = [dict(_flat(message)) for message in recording.messages(topic)]
        names = dict.fromkeys(name for row in rows for name in row)
        rest = [_column(name, known.get(name.partition("[")[0], ""), [row.get(name) for row in rows]) for name in names]
    said = comments_in(recording, topic)
    rest = [column._replace(comment=said.get(column.name.partition("[")[0], "")) for column in rest]
    lifted = map(_absolute, rest) if absolute and (topic in GAUGE or topic.startswith(of_tap(""))) else rest
    return [Column("time", "s", time), *lifted]


def _absolute(column: Column) -> Column:
    return column._replace(unit="Pa abs", values=column.values + AMBIENT) if column.unit == "Pa" else column


def _column(name: str, unit: str, values: list[Any]) -> Column:
    if all(isinstance(value, int | float | np.number) for value in values):
        return Column(name, unit, np.array(values))
    return Column(name, unit, ["" if value is None else str(value) for value in values])


def _flat(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Names and values of a message; an array of numbers becomes as many columns, a list of texts one."""
    if is_dataclass(value):
        for field in fields(value):
            if not field.name.startswith("__"):
                yield from _flat(getattr(value, field.name), f"{name}.{field.name}" if name else field.name)
    elif isinstance(value, np.ndarray):
        yield from ((f"{name}[{i}]", entry) for i, entry in enumerate(value.tolist()))
    else:
        yield name, json.dumps(value) if isinstance(value, list) else value
