"""The numbers of a scenario that may change while it runs: their names, units, limits, and what a new one means."""

import difflib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from bridge.errors import LIKENESS, ScenarioError
from bridge.scenario.channels import chosen
from bridge.scenario.controllers import parameter_in_si
from bridge.scenario.fields import Gain, Measured
from bridge.scenario.gains import scale_of
from bridge.scenario.mistakes import lines
from bridge.scenario.units import quantity
from controller.reference import evaluate
from twin.rig import BUILT_IN, RIG, Number
from twin.topology import CHANNELS

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

REFERENCE = "reference"
SUCH = ("rig.load.force", "sensor.p2.offset", "controller.gain", REFERENCE)
SENSOR, FURTHER = "sensor", "channel"  # transducers of the card's own channels, and of further ones
PLANT, CONTROLLER = "plant", "controller"


class Tunable(NamedTuple):
    """A number that may change during a run."""

    name: str
    unit: str  # SI
    owner: str  # PLANT, CONTROLLER
    value: float  # of the scenario, SI; of the reference at time 0
    low: float | None
    high: float | None
    description: str


def tunables(scenario: "Scenario") -> dict[str, Tunable]:
    """All of them by name: rig.load.force, sensor.p2.offset, controller.gain, reference."""
    found = [*_of_rig(scenario), *_of_sensors(scenario), *_of_controller(scenario)]
    if scenario.controller.follows:
        start = evaluate(scenario.reference.reference(), 0.0).position
        reach = 0.0, scenario.rig.cylinder.stroke
        found.append(Tunable(REFERENCE, "m", CONTROLLER, start, *reach, "in place of the scenario's reference"))
    return {entry.name: entry for entry in found}


def tunable(name: str, scenario: "Scenario") -> Tunable:
    """One of them. Raises ScenarioError for another name, with the reason where there is one."""
    known = tunables(scenario)
    if name in known:
        return known[name]
    reason = BUILT_IN.get(name.removeprefix("rig."))
    if name.startswith("rig.") and reason:
        raise ScenarioError(f"{name} cannot change while the rig runs: {reason}")
    near = difflib.get_close_matches(name, known, n=1, cutoff=LIKENESS)
    words = f"did you mean {near[0]!r}?" if near else f"such are {', '.join(SUCH)}"
    raise ScenarioError(f"{name!r} is not a number that can change during a run; {words}")


def in_si(value: object, entry: Tunable, scenario: "Scenario") -> float:
    """A number, or a text with a unit, as the entry's number in SI. Raises ScenarioError outside its limits."""
    try:
        number = _in_si(value, entry, scenario)
    except ValueError as error:
        raise ScenarioError(f"{entry.name} = {value!r}: {error}") from None
    return within(number, entry, scenario)


def difference_in_si(value: object, entry: Tunable, scenario: "Scenario") -> float:
    """A number to add to the entry's, in SI, without limits; a difference of temperatures too. Raises ScenarioError."""
    try:
        return _in_si(value, entry, scenario) - (_in_si(f"0 {_unit(value)}", entry, scenario) if _unit(value) else 0.0)
    except ValueError as error:
        raise ScenarioError(f"{entry.name}: {value!r}: {error}") from None


def _unit(value: object) -> str:
    from bridge.scenario.units import split

    return split(value)[1] if isinstance(value, str) else ""


def within(number: float, entry: Tunable, scenario: "Scenario") -> float:
    """The number itself. Raises ScenarioError outside its limits, or where the owner refuses it."""
    low, high = entry.low, entry.high
    if low is not None and number < low:
        raise ScenarioError(f"{entry.name} = {number:g}: must be at least {low:g} {entry.unit}".rstrip())
    if high is not None and number > high:
        raise ScenarioError(f"{entry.name} = {number:g}: must be at most {high:g} {entry.unit}".rstrip())
    if entry.owner == CONTROLLER and entry.name != REFERENCE:
        with_controller(scenario, {entry.name: number})
    return number


def with_controller(scenario: "Scenario", numbers: dict[str, float]) -> "Scenario":
    """The scenario with other numbers (SI) of its controller. Raises ScenarioError where that refuses them."""
    from pydantic import ValidationError

    controller = scenario.controller
    plain = controller.model_dump()
    for name, number in numbers.items():
        _, _, key = name.partition(".")
        if key.startswith("parameters."):
            plain["parameters"] = plain["parameters"] | {key.removeprefix("parameters."): number}
        else:
            gain = _marked(controller, key, Gain)
            plain[key] = f"{number!r} {gain.units[1]}" if gain else number
    try:
        changed = type(controller).model_validate(plain)
        changed.refuse_period(scenario.loop.sample_period)
    except ValidationError as error:
        raise ScenarioError(f"controller.{next(lines(error))}") from None
    except ValueError as error:
        raise ScenarioError(str(error)) from None
    return scenario.model_copy(update={"controller": changed})


def _in_si(value: object, entry: Tunable, scenario: "Scenario") -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError("give a number, or a text with a unit")
    key = entry.name.partition(".")[2]
    if entry.owner == CONTROLLER and (gain := _marked(scenario.controller, key, Gain)):
        return scale_of(scenario).per_metre(gain.read(value))
    if key.startswith("parameters."):
        number = parameter_in_si(value, scale_of(scenario))
        if isinstance(number, str) or number != number:
            raise ValueError("give a number, or a text with a unit")
        return float(number)
    number = quantity(value, entry.unit)
    if number != number:
        raise ValueError("it is not a number")
    return number


def _of_rig(scenario: "Scenario") -> Iterator[Tunable]:
    own = scenario.rig_values()
    for part, entries in RIG.items():
        for key, entry in entries.items():
            if isinstance(entry, Number) and f"{part}.{key}" not in BUILT_IN:
                limits = _finite(entry.low), _finite(entry.high)
                yield Tunable(f"rig.{part}.{key}", entry.unit, PLANT, own[part][key], *limits, entry.source)


def _of_sensors(scenario: "Scenario") -> Iterator[Tunable]:
    for name, channel in CHANNELS.items():
        span = float(getattr(scenario.daq, channel.span))
        yield from _of_transducer(f"{SENSOR}.{name}", channel.unit, span, scenario)
    for name, sensor in chosen(scenario).items():
        yield from _of_transducer(f"{FURTHER}.{name}", sensor.unit, sensor.ends(scenario.daq)[1], scenario)


def _of_transducer(name: str, unit: str, span: float, scenario: "Scenario") -> Iterator[Tunable]:
    yield Tunable(f"{name}.offset", unit, PLANT, 0.0, -span, span, "added to the true value")
    yield Tunable(f"{name}.noise", "", PLANT, scenario.daq.noise, 0.0, None, "LSB rms")


def _of_controller(scenario: "Scenario") -> Iterator[Tunable]:
    controller, scale = scenario.controller, scale_of(scenario)
    for key, field in type(controller).model_fields.items():
        value, words = getattr(controller, key), field.description or ""
        if gain := _marked(controller, key, Gain):
            yield Tunable(f"controller.{key}", gain.units[1], CONTROLLER, scale.per_metre(value), None, None, words)
        elif measured := _marked(controller, key, Measured):
            yield Tunable(f"controller.{key}", measured.unit, CONTROLLER, float(value), None, None, words)
        elif key == "parameters":
            yield from _of_law(getattr(controller.gains(scale), key))


def _of_law(parameters: dict[str, Any]) -> Iterator[Tunable]:
    for name, value in parameters.items():
        if isinstance(value, int | float) and not isinstance(value, bool):
            words = "parameter of the law"
            yield Tunable(f"controller.parameters.{name}", "", CONTROLLER, float(value), None, None, words)


def _marked(controller: Any, key: str, kind: type[Any]) -> Any:
    """What reads a field of a controller, if it is of a kind."""
    field = type(controller).model_fields.get(key)
    return next((mark for mark in field.metadata if isinstance(mark, kind)), None) if field else None


def _finite(limit: float) -> float | None:
    return None if limit in (float("inf"), float("-inf")) else limit
