"""modelDescription.xml: what an importer reads of an FMU before it loads anything."""

import math
from importlib.metadata import version as installed
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from bridge.connect.fmu.made import Made
from bridge.connect.fmu.variable import Role, Type, Variable
from bridge.scenario import Scenario
from bridge.scenario.unit_dimensions import OFFSETS, dimensions
from controller.grid import NS

ELEMENTS = {  # of a type, by version of FMI
    "2": {Type.REAL: "Real", Type.WHOLE: "Integer", Type.TRUTH: "Boolean"},
    "3": {Type.REAL: "Float64", Type.WHOLE: "Int64", Type.TRUTH: "Boolean"},
}
CAUSALITY = {
    Role.FIXED: "parameter",
    Role.TUNABLE: "parameter",
    Role.INPUT: "input",
    Role.OUTPUT: "output",
    Role.CONSTANT: "local",
    Role.TIME: "independent",
}
VARIABILITY = {Role.FIXED: "fixed", Role.TUNABLE: "tunable", Role.CONSTANT: "constant"}
CATEGORIES = ("logStatusWarning", "logStatusError")
STATES = {"2": ("canGetAndSetFMUstate", "canSerializeFMUstate"), "3": ("canGetAndSetFMUState", "canSerializeFMUState")}
TOKEN = {"2": "guid", "3": "instantiationToken"}


def describe(made: Made, scenario: Scenario, version: str, identifier: str, token: str) -> bytes:
    """The file for a version of FMI, 2 or 3."""
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": f"{version}.0",
            "modelName": f"hydrotwin {made.kind} {scenario.name}",
            TOKEN[version]: token,
            "description": scenario.title or f"the {made.kind} of {scenario.name}",
            "generationTool": f"hydrotwin {installed('hydrotwin')}",
            "variableNamingConvention": "structured",
        },
    )
    flags = dict.fromkeys((*STATES[version], "canHandleVariableCommunicationStepSize"), "true")
    SubElement(root, "CoSimulation", {"modelIdentifier": identifier, **flags})
    _units(root, made.variables)
    categories = SubElement(root, "LogCategories")
    for name in CATEGORIES:
        SubElement(categories, "Category", name=name)
    experiment = {"startTime": "0", "stopTime": _number(scenario.duration), "stepSize": _number(made.period / NS)}
    SubElement(root, "DefaultExperiment", experiment)
    {"2": _variables_2, "3": _variables_3}[version](root, made.variables)
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="utf-8") + b"\n"


def _units(root: Element, variables: list[Variable]) -> None:
    found = dict.fromkeys(variable.unit for variable in variables if variable.unit)
    if not found:
        return
    definitions = SubElement(root, "UnitDefinitions")
    for unit in found:
        base = {name: str(exponent) for name, exponent in dimensions(unit).items()}
        offset = {"offset": _number(OFFSETS[unit])} if unit in OFFSETS else {}
        SubElement(SubElement(definitions, "Unit", name=unit), "BaseUnit", base | offset)


def _variables_2(root: Element, variables: list[Variable]) -> None:
    listed = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(variables):
        scalar = SubElement(listed, "ScalarVariable", _common(variable, reference) | _initial(variable))
        SubElement(scalar, ELEMENTS["2"][variable.type], _value(variable))
    outputs = [str(place) for place, v in enumerate(variables, 1) if v.role is Role.OUTPUT]
    structure = SubElement(root, "ModelStructure")
    for name in ("Outputs", "InitialUnknowns"):
        unknowns = SubElement(structure, name)
        for index in outputs:
            SubElement(unknowns, "Unknown", index=index)


def _variables_3(root: Element, variables: list[Variable]) -> None:
    listed = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(variables):
        given = _common(variable, reference) | _initial(variable) | _value(variable)
        SubElement(listed, ELEMENTS["3"][variable.type], given)
    structure = SubElement(root, "ModelStructure")
    for name in ("Output", "InitialUnknown"):
        for reference, variable in enumerate(variables):
            if variable.role is Role.OUTPUT:
                SubElement(structure, name, valueReference=str(reference))


def _common(variable: Variable, reference: int) -> dict[str, str]:
    found = {"name": variable.name, "valueReference": str(reference), "causality": CAUSALITY[variable.role]}
    if variable.words:
        found["description"] = variable.words.strip(" ,")
    usual = "continuous" if variable.type is Type.REAL else "discrete"
    return found | {"variability": VARIABILITY.get(variable.role, usual)}


def _initial(variable: Variable) -> dict[str, str]:
    words = {Role.OUTPUT: "calculated", Role.FIXED: "exact", Role.TUNABLE: "exact", Role.CONSTANT: "exact"}
    return {"initial": words[variable.role]} if variable.role in words else {}


def _value(variable: Variable) -> dict[str, str]:
    found: dict[str, str] = {}
    if variable.type is not Type.TRUTH:
        found |= {name: _of(variable, limit) for name, limit in _limits(variable) if math.isfinite(limit)}
    if variable.unit:
        found["unit"] = variable.unit
    if variable.role not in (Role.OUTPUT, Role.TIME):
        found["start"] = _of(variable, variable.start)
    return found


def _limits(variable: Variable) -> Any:
    return ("min", variable.low), ("max", variable.high)


def _of(variable: Variable, value: float) -> str:
    if variable.type is Type.TRUTH:
        return "true" if value else "false"
    return str(int(value)) if variable.type is Type.WHOLE else _number(value)


def _number(value: float) -> str:
    """As XML writes it, to the last bit."""
    return "INF" if value == math.inf else "-INF" if value == -math.inf else repr(float(value))
