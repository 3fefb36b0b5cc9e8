"""Scenarios: what is simulated, controlled and expected, as TOML checked on the way in."""

from typing import TYPE_CHECKING, Any

from bridge.errors import ScenarioError
from bridge.scenario.files import names
from bridge.scenario.loading import changed, check, load

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

__all__ = ["Scenario", "ScenarioError", "changed", "check", "load", "names"]


def __getattr__(name: str) -> Any:
    """The model is built when it is asked for: what is refused before that does not wait for it."""
    if name != "Scenario":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from bridge.scenario.model import Scenario

    return Scenario
