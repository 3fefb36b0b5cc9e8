"""Scenarios: what is simulated, controlled and expected, as TOML checked on the way in."""

from bridge.scenario.loading import ScenarioError, changed, check, load, names
from bridge.scenario.model import Scenario

__all__ = ["Scenario", "ScenarioError", "changed", "check", "load", "names"]
