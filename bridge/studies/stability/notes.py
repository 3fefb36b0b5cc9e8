"""What people should know beside the theory's answer for a scenario's loop."""

from typing import Any

from bridge.scenario import Scenario
from bridge.studies.stability.sampled_law import FreeGain, is_asked

MOST_DELAY = 50.0  # sampling periods; more are likely a missing unit


def notes_on(scenario: Scenario, free: FreeGain) -> list[str]:
    """On the delay, and on what is free of a law that is not a PD."""
    notes = timing_notes(scenario)
    own: Any = scenario.controller
    what = "a factor on its answer" if free.is_factor else "controller.gain"
    itself = f"itself ran in the reduced loop; free is {what}"
    if own.kind == "python":
        notes.append(f"controller.law {own.law!r} {itself}")
    elif own.kind == "c":
        notes.append(f"the law in {own.source or own.library!r} {itself}")
    elif own.kind == "fmu":
        notes.append(f"the FMU {own.fmu!r} {itself}")
    elif own.kind == "state-space":
        how = f", which ran itself, since it reads {', '.join(own.inputs)}" if is_asked(scenario) else ""
        notes.append(f"free is a factor on C and D of the law{how}")
    return notes


def timing_notes(scenario: Scenario) -> list[str]:
    """A delay of very many periods is likely one without its unit; nothing for a controller that closes no loop."""
    delay, period = scenario.loop.delay, scenario.loop.sample_period
    if delay <= MOST_DELAY * period or not scenario.controller.follows:
        return []
    return [f"loop.delay is {delay:g} s, {delay / period:.0f} sampling periods: a unit may be missing, as in '10 ms'"]
