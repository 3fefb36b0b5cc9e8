"""The message `channels`: flat as those of the loop, with fields that follow from the scenario.

On the bus it is known by its length. In a recording the schema has a field for each channel, with its unit.
"""

import re
from typing import NamedTuple

from bridge.wire.messages import TEXTS, VARYING, struct_format

_FIELD = re.compile(r"^float64 (\w+) +# \[([^\]]*)\](.*)$", re.MULTILINE)
NO_UNIT = "share"
GENERAL = TEXTS[VARYING].splitlines(keepends=True)[1:3]  # what is said of it where the scenario is not known


class ChannelField(NamedTuple):
    """One further channel."""

    name: str
    unit: str  # SI
    note: str  # behind the unit


Layout = tuple[ChannelField, ...]  # of a run's message


def text_of(layout: Layout) -> str:
    """The `.msg` text of the message."""
    width = max((len(field.name) for field in layout), default=0)
    lines = (f"float64 {name:{width}}  # [{unit or NO_UNIT}]{note}\n" for name, unit, note in layout)
    head = (line for line in TEXTS[VARYING].splitlines(keepends=True) if line not in GENERAL)
    return "".join((*head, *lines))


def layout_in(text: str) -> Layout:
    """The layout that such a text describes."""
    return tuple(ChannelField(name, unit.replace(NO_UNIT, ""), note) for name, unit, note in _FIELD.findall(text))


def format_of(layout: Layout) -> str:
    """The `struct` format of the message, header skipped."""
    return f"{struct_format(VARYING)}{'d' * len(layout)}"
