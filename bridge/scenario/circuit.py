"""The circuit of a scenario's rig, built where it is needed and once for the same numbers."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from bridge.errors import ScenarioError
from bridge.scenario.model import Scenario
from twin.circuit.build import build
from twin.circuit.step import Circuit

REMEMBERED = 8  # circuits: a sweep over a number of the rig needs each of its own only once
Plain = tuple[tuple[str, tuple[tuple[str, Any], ...]], ...]  # the rig's values, part by part


def circuit_of(scenario: Scenario) -> Circuit:
    """The circuit at the scenario's step. Raises ScenarioError where its numbers make none, or none at this step."""
    try:
        return _built(_plain(scenario.rig_values()), scenario.loop.step)
    except ValueError as error:
        raise ScenarioError(f"{scenario.name}: {error}") from None


def _plain(values: Mapping[str, Mapping[str, Any]]) -> Plain:
    return tuple((part, tuple(entries.items())) for part, entries in values.items())


@lru_cache(REMEMBERED)
def _built(values: Plain, step: float) -> Circuit:
    return build({part: dict(entries) for part, entries in values}, step)
