"""Scenarios checked on the way in, with one line per mistake."""

import copy
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bridge.errors import ScenarioError
from bridge.scenario.files import apply, ordered, plain, with_tables
from bridge.scenario.inherited import gives_channels, without_unfitted

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario


def load(which: str, changes: list[str] | None = None) -> "Scenario":
    """A built-in scenario by name, or a TOML (or JSON) file by path, with changes such as "controller.gain=0.4".

    Raises ScenarioError with one line per mistake.
    """
    return changed(plain(which), changes or [], which)


def changed(data: dict[str, Any], changes: Collection[str], which: str) -> "Scenario":
    """The scenario that plain data describe, with changes. Raises ScenarioError with one line per mistake."""
    own = copy.deepcopy(data)
    for change in ordered(changes):
        apply(own, change)
    own = without_unfitted(own, data, gives_channels(changes)) if changes else own
    return check(with_tables(own, Path()), which)


def check(data: dict[str, Any], which: str) -> "Scenario":
    """The scenario that plain data describe. Raises ScenarioError with one line per mistake."""
    from pydantic import ValidationError

    from bridge.scenario.mistakes import lines
    from bridge.scenario.model import Scenario

    try:
        return Scenario.model_validate(data)
    except ValidationError as error:
        raise ScenarioError("\n".join(f"{which}: {line}" for line in lines(error))) from None


FASTEST_DAQ = 0.2e-3  # [s] of wall time


def refuse_fast_daq(scenario: "Scenario", speed: float) -> None:
    """Real time goes to 5 kHz; faster acquisition is for lockstep and in process."""
    least = FASTEST_DAQ * speed
    if scenario.loop.daq_period < least * 0.999:
        raise ScenarioError(
            f"loop.daq_period {scenario.loop.daq_period:g} s at speed {speed:g}: real time goes to 5 kHz; "
            f"nearest valid: {least:g} s; faster with --mode lockstep or inprocess"
        )
