"""What a plant or a controller gives to be made an FMU of."""

from typing import NamedTuple

from bridge.connect.fmu.variable import Variable


class Made(NamedTuple):
    """Sources and numbers."""

    kind: str  # plant, controller
    variables: list[Variable]
    own_state: str  # header of the state
    macros: dict[str, str | int | float]  # of data.h
    sources: dict[str, str]  # made for the scenario: name, text
    ours: tuple[str, ...]  # sources of the folder `c`
    headers: tuple[str, ...]  # the same
    period: int  # that a host should step by [ns]
    objects: dict[str, dict[str, bytes]]  # of each platform by its name: object files; none of a law, which is C
    folder: str = ""  # where a user's law finds what it includes
