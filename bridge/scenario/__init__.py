"""Scenarios: what is simulated, controlled and expected, as TOML checked on the way in."""

from bridge.errors import ScenarioError
from bridge.scenario.loading import changed, check, load, names
from bridge.scenario.model import Scenario

__all__ = ["Scenario", "ScenarioError", "changed", "check", "load", "names"]
