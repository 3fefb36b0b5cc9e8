"""Parameters of a law of one's own: what a scenario may write under `controller.parameters`."""

from keyword import iskeyword
from typing import Any

from bridge.scenario.units import si, split


def parameters_of(values: dict[str, Any]) -> dict[str, Any]:
    """What stands under controller.parameters. Raises ValueError for what is not a parameter."""
    for name, value in values.items():
        if not name.isidentifier() or iskeyword(name):
            raise ValueError(f"{name!r} is not a name of a parameter: letters, digits and _, not a digit first")
        entries = value if isinstance(value, list) else [value]
        if not all(isinstance(entry, bool | int | float | str) for entry in entries):
            raise ValueError(f"{name} = {value!r}: a parameter is a number, a text, true or false, or a list of these")
        for entry in entries:
            if entry != entry:
                raise ValueError(f"{name} is not a number; give one, or leave the parameter out")
            if isinstance(entry, str) and not is_gain(entry):
                si(entry)
    return values


def only_numbers(values: dict[str, Any]) -> dict[str, Any]:
    """Parameters of a law in C. Raises ValueError for one that is not a number."""
    for name, value in values.items():
        if isinstance(value, list) or (isinstance(value, str) and not is_gain(value) and isinstance(si(value), str)):
            raise ValueError(f"{name} = {value!r}: a law in C takes numbers; give one, or a text with a unit")
    return values


def is_gain(text: str) -> bool:
    """Is it in volts per % of the stroke?"""
    try:
        return split(text)[1] in ("V/%", "V s/%", "V/(% s)")
    except ValueError:
        return False
