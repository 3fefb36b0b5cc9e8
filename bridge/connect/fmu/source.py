"""The C sources of an FMU that are made for a scenario: its variables, and tables of numbers."""

import math
from collections.abc import Iterable

from bridge.connect.fmu.trace import literal
from bridge.connect.fmu.variable import Role, Type, Variable

PER_LINE = 8


def header(variables: list[Variable], token: str, own_state: str, macros: dict[str, str | int | float]) -> str:
    """data.h: the sizes, and where variables begin."""
    given = {"VARIABLES": len(variables), "TOKEN": f'"{token}"', "OWN_STATE": f'"{own_state}"', **macros}
    lines = [f"#define {name} {_plain(value)}" for name, value in given.items()]
    return "\n".join(["/* Made for a scenario. */", *lines, ""])


def table_of(variables: list[Variable]) -> str:
    """The array of the variables."""
    rows = [_row(variable) for variable in variables]
    return "\n".join(["const variable variables[VARIABLES] = {", *rows, "};", ""])


def doubles(name: str, size: str, values: Iterable[float]) -> str:
    """An array of numbers, to the last bit."""
    return _array("double", name, size, [literal(value) for value in values])


def wholes(name: str, size: str, values: Iterable[int], kind: str = "int64_t", end: str = "") -> str:
    """An array of whole numbers."""
    return _array(kind, name, size, [f"{value}{end}" for value in values])


def rows(kind: str, name: str, size: str, entries: list[str]) -> str:
    """An array of structs of four fields, with an empty one at its end, since C has no empty arrays."""
    body = ",\n".join(f"  {{{entry}}}" for entry in [*entries, "0, 0, 0, 0"])
    return f"const {kind} {name}[{size} + 1] = {{\n{body}}};\n"


def _array(kind: str, name: str, size: str, texts: list[str]) -> str:
    lines = [", ".join(texts[at : at + PER_LINE]) for at in range(0, len(texts), PER_LINE)]
    return f"const {kind} {name}[{size}] = {{\n  " + ",\n  ".join(lines) + "};\n"


def _row(variable: Variable) -> str:
    role = Role.OUTPUT if variable.role is Role.TIME else variable.role
    field = "real" if variable.type is Type.REAL else "whole"
    start = literal(variable.start) if variable.type is Type.REAL else str(int(variable.start))
    limits = f"{literal(variable.low)}, {literal(variable.high)}"
    return f'  {{"{variable.name}", {variable.type}, {role}, {limits}, {{.{field} = {start}}}}},'


def _plain(value: str | int | float) -> str:
    return literal(value) if isinstance(value, float) and math.isfinite(value) else str(value)
