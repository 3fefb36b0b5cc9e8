"""Parameters of a user's law: what the scenario gives, checked against what the law's module declares."""

import dataclasses
from types import SimpleNamespace
from typing import Any, get_type_hints

from bridge.errors import ScenarioError, nearest

PLACE = "controller.parameters"


class Free(SimpleNamespace):
    """Parameters that no module declares."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        known = ", ".join(vars(self)) or "none"
        raise AttributeError(f"there is no {PLACE}.{name} (given: {known})")


def filled(given: dict[str, Any], declared: Any, where: str) -> Any:
    """The parameters as the law gets them.

    declared: a dataclass or a pydantic model, or None; where: its file. Raises ScenarioError, a line per mistake.
    """
    if declared is None:
        return Free(**given)
    if dataclasses.is_dataclass(declared) and isinstance(declared, type):
        return _dataclass(given, declared, where)
    if hasattr(declared, "model_validate"):
        return _model(given, declared, where)
    raise ScenarioError(f"{where}: Parameters is neither a dataclass nor a pydantic model")


def plain(parameters: Any) -> dict[str, Any]:
    """Parameters by name, those that the law's module has filled in as well."""
    if isinstance(parameters, dict):
        return parameters
    if hasattr(parameters, "model_dump"):
        return parameters.model_dump()
    if dataclasses.is_dataclass(parameters) and not isinstance(parameters, type):
        return dataclasses.asdict(parameters)
    return dict(vars(parameters))


def _dataclass(given: dict[str, Any], declared: type[Any], where: str) -> Any:
    fields = {field.name: field for field in dataclasses.fields(declared) if field.init}
    wrong = [f"{PLACE}.{name}: {where} declares none{nearest(name, fields)}" for name in given if name not in fields]
    required = [name for name, field in fields.items() if _needed(field) and name not in given]
    wrong += [f"{PLACE}.{name}: {where} wants it and has no default" for name in required]
    hints, values = get_type_hints(declared), {}
    for name in given.keys() & fields.keys():
        values[name], complaint = _fitting(given[name], hints.get(name, Any))
        wrong += [f"{PLACE}.{name} = {given[name]!r}: {where} wants {complaint}"] if complaint else []
    if wrong:
        raise ScenarioError("\n".join(wrong))
    try:
        return declared(**values)
    except (TypeError, ValueError) as error:
        raise ScenarioError(f"{PLACE}: {where}: {error}") from None


def _needed(field: "dataclasses.Field[Any]") -> bool:
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


WANTED = {float: "a number", int: "a whole number", bool: "true or false", str: "a text"}


def _fitting(value: Any, kind: Any) -> tuple[Any, str]:
    """The value as its type has it, and what is wanted where it does not fit."""
    if kind is float and isinstance(value, int | float) and not isinstance(value, bool):
        return float(value), ""
    fits = kind not in WANTED or (isinstance(value, kind) and isinstance(value, bool) == (kind is bool))
    return value, "" if fits else WANTED[kind]


def _model(given: dict[str, Any], declared: Any, where: str) -> Any:
    from pydantic import ValidationError

    if unknown := [name for name in given if name not in declared.model_fields]:
        known = declared.model_fields
        raise ScenarioError("\n".join(f"{PLACE}.{n}: {where} declares none{nearest(n, known)}" for n in unknown))
    try:
        return declared.model_validate(given)
    except ValidationError as errors:
        from bridge.scenario.mistakes import lines

        raise ScenarioError("\n".join(f"{PLACE}.{line}, by {where}" for line in lines(errors))) from None
