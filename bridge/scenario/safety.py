"""The sections `[safety]` and `[[alarm]]`: which limits stop a plant, and what it does then."""

from typing import TYPE_CHECKING, NamedTuple

from pydantic import Field

from bridge.scenario.channels import chosen
from bridge.scenario.conditions import Crossing, crossing, unit_of
from bridge.scenario.fields import Fraction, Line, Metres, Part, Seconds
from bridge.scenario.units import UNITS, quantity, shown, split
from bridge.wire.messages import CHANNELS_TOPIC, OnTrip, SafetyState
from controller.grid import to_ns

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

LONGEST = 60.0  # [s] of a ramp, so that its stairs fit


class Safety(Part):
    """What the valve does in the safe state, and while the plant is degraded."""

    on_trip: OnTrip = Field(default=OnTrip.SHUT_OFF, description="what the valve does in the safe state")
    ramp: Seconds = Field(default=0.2, gt=0.0, le=LONGEST, description="of the ramp, to the centre, assumed")
    retreat_spool: Fraction | None = Field(default=None, ge=-1.0, le=1.0, description="spool reference of the retreat")
    retreat_position: Metres | None = Field(default=None, description="where the retreat ends: the card's reading")
    retreat_within: Seconds = Field(default=5.0, gt=0.0, description="after so long the retreat ends anyway, assumed")
    degraded_limit: Fraction = Field(
        default=1.0, ge=0.0, le=1.0, description="greatest spool reference that acts while degraded, either way"
    )


class Alarm(Part):
    """A limit, and where it leads the plant."""

    id: Line = Field(default="", description="a short name; by default the number of the entry")
    text: Line = Field(default="", description="in the words of a requirement")
    when: Line = Field(description='"p1 > 100 bar", "measurement.position > 280 mm", "channels.force > 10 kN"')
    lasts: Seconds = Field(default=0.0, ge=0.0, description="how long the signal must have been past the limit")
    then: SafetyState = Field(default=SafetyState.SAFE, description="degraded, safe or latched")
    hysteresis: float | str = Field(default=0.0, description="how far back from the limit the alarm is gone")
    clears_after: Seconds = Field(default=0.0, ge=0.0, description="and for how long the signal must be there")


class PlannedAlarm(NamedTuple):
    """An alarm, ready to be watched."""

    number: int  # from 1, in the order of the scenario
    id: str
    condition: Crossing
    unit: str  # SI, of its signal
    lasts: int  # [ns]
    then: SafetyState
    hysteresis: float  # SI
    clears_after: int  # [ns]
    words: str  # the condition, for events


def planned(scenario: "Scenario") -> list[PlannedAlarm]:
    """The alarms of a scenario. Raises ValueError that names the alarm, what is wrong and the way out."""
    found: list[PlannedAlarm] = []
    for number, alarm in enumerate(scenario.alarm, 1):
        try:
            found.append(_planned(number, alarm, scenario))
        except ValueError as error:
            raise ValueError(f"alarm {number}: {error}") from None
        if found[-1].id in [other.id for other in found[:-1]]:
            raise ValueError(f"alarm {number}: the id {found[-1].id!r} is taken by another alarm")
    return found


def _planned(number: int, alarm: Alarm, scenario: "Scenario") -> PlannedAlarm:
    further = {f"{CHANNELS_TOPIC}.{name}": sensor.unit for name, sensor in chosen(scenario).items()}
    condition = crossing(alarm.when, further=further, strict=True)
    unit = unit_of(condition, further)
    if alarm.then == SafetyState.RUNNING:
        raise ValueError("then = 'running' is where the plant is anyway; write degraded, safe or latched")
    words = f"{alarm.when}{f' for {alarm.lasts:g} s' if alarm.lasts else ''}{f' ({alarm.text})' if alarm.text else ''}"
    return PlannedAlarm(
        number,
        alarm.id or str(number),
        condition,
        unit,
        to_ns(alarm.lasts),
        alarm.then,
        _hysteresis(alarm.hysteresis, unit),
        to_ns(alarm.clears_after),
        words,
    )


def _hysteresis(value: float | str, unit: str) -> float:
    number = quantity(value, unit)
    if isinstance(value, str) and unit in UNITS:
        number -= UNITS[unit][split(value)[1] or unit].offset  # a difference, of temperatures too
    if not 0.0 <= number < float("inf"):
        raise ValueError(f"hysteresis {value!r}: must be 0 or more, and finite")
    return number


def refuse_unsafe(scenario: "Scenario") -> None:
    """Raises ValueError for alarms that cannot be watched, and for a retreat that says not all it needs."""
    planned(scenario)
    safety, stroke = scenario.safety, scenario.rig.cylinder.stroke
    lacks = [name for name in ("retreat_spool", "retreat_position") if getattr(safety, name) is None]
    if safety.on_trip == OnTrip.RETREAT and lacks:
        raise ValueError(f"safety.on_trip = 'retreat' needs safety.{lacks[0]}")
    if safety.retreat_position is not None and not 0.0 <= safety.retreat_position <= stroke:
        raise ValueError(
            f"safety.retreat_position {safety.retreat_position:g} m lies outside the stroke, 0 to {stroke:g} m"
        )


def value_in_words(value: float, unit: str) -> str:
    """A reading of a signal as people read it."""
    factor, name = shown(unit)
    return f"{value * factor:.4g} {name}".rstrip()
