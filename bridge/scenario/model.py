"""The sections of a scenario, and the scenario: what is simulated, controlled and expected."""

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Field, create_model, model_validator

from bridge.errors import ScenarioError
from bridge.scenario.bands import parse_band, refuse_unread
from bridge.scenario.channels import refuse_unknown
from bridge.scenario.controllers import Controller, Pd
from bridge.scenario.faults import Fault
from bridge.scenario.fields import (
    Acceleration,
    Bits,
    ChannelName,
    CommandShare,
    FileName,
    Flow,
    Force,
    LeastBits,
    Line,
    Measured,
    Metres,
    Part,
    Pressure,
    Seconds,
    Speed,
    TickShare,
    Volume,
)
from bridge.scenario.files import DURATION
from bridge.scenario.plant_faults import fit_holes, refuse_powerless
from bridge.scenario.reach import refuse_far
from bridge.scenario.references import Reference
from bridge.scenario.requirements import Expectation, Expected
from bridge.scenario.safety import Alarm, Safety, refuse_unsafe
from bridge.scenario.timeline import Happening, plan
from bridge.wire.messages import OnOverrun
from controller.grid import NS, Sampling, sampling
from twin.quantity import Choice, Entry, Table
from twin.rig import RIG, values
from twin.topology import CHANNELS

SKEW = 5e-6  # [s], 2.2.2
NOT_GAUGE = (  # in names of numbers in Pa: differences of pressures, and moduli
    *("drop", "droop", "override", "hysteresis", "check", "accessory_a.cracking", "accessory_b.cracking"),
    *("modulus", "young"),
)


class Start(Part):
    """Where the piston waits, at rest with the valve shut."""

    position: Metres = Field(default=0.1, description="piston [m], from the lower end")
    p_upper: Pressure = Field(default=0.0, ge=0.0, description="upper chamber [Pa], gauge; the lower carries the rest")


class Loop(Part):
    """The time grid, and what happens when commands stop."""

    step: Seconds = Field(default=50e-6, gt=0.0, description="internal step; divides the DAQ period")
    daq_period: Seconds = Field(default=1e-3, gt=0.0, description="from measurement to measurement")
    sample_period: Seconds = Field(default=10e-3, gt=0.0, description="of the controller, whole DAQ periods")
    offset: Seconds = Field(default=0.0, ge=0.0, description="of the first sample, whole DAQ periods")
    delay: Seconds = Field(default=0.0, ge=0.0, le=10.0, description="from sample to action, whole internal steps")
    command_timeout: Seconds = Field(default=0.1, gt=0.0, description="silence after which the plant is safe")
    after_timeout: Literal["latch", "resume"] = Field(
        default="latch", description="stay safe until reset, or until commands resume"
    )
    viewer_period: Seconds = Field(default=20e-3, gt=0.0, description="of the standard messages for viewers")

    def grid(self) -> Sampling:
        """The same in nanoseconds; ValueError for what is off the grid."""
        return sampling(self.step, self.daq_period, self.sample_period, self.offset, self.delay)


class Daq(Part):
    """The data acquisition card; each of its effects can be switched off."""

    bits: Bits = Field(default=12.0, ge=1.0, le=32.0, description="2.2.2")
    position_range: Metres = Field(default=0.3, gt=0.0, description="0 to this, 2.2.2")
    velocity_range: Speed = Field(default=1.0, gt=0.0, description="+- this, tachometer, assumed")
    pressure_range: Pressure = Field(default=250e5, gt=0.0, description="0 to this, assumed")
    noise: LeastBits = Field(default=0.5, ge=0.0, description="LSB rms, assumed; 0 for none")
    skew: Seconds = Field(default=SKEW, ge=0.0, description="from channel to channel, 2.2.2; 0 for none")
    quantise: bool = True
    clip: bool = True
    tachometer: bool = True
    output_bits: Bits = Field(
        default=12.0, ge=1.0, le=32.0, description="2.2.2; 0 to 10 V, assumed to span the valve's whole input"
    )
    quantise_output: bool = True
    channels: list[ChannelName] = Field(default=[], description="further ones, docs/recordings.md")
    flow_range: Flow = Field(default=100e-3 / 60.0, gt=0.0, description="of further channels, +- this, assumed")
    force_range: Force = Field(default=20e3, gt=0.0, description="of a further channel, +- this, assumed")
    acceleration_range: Acceleration = Field(default=100.0, gt=0.0, description="+- this, assumed")
    volume_range: Volume = Field(default=10e-3, gt=0.0, description="of a further channel, 0 to this, assumed")
    lift_range: Metres = Field(default=6e-3, gt=0.0, description="of further channels, 0 to this, assumed")


class RealTime(Part):
    """When a real-time run counts as failed: late commands change the data, late ticks only when they are published."""

    late_commands: CommandShare = Field(
        default=0.02, ge=0.0, le=1.0, description="share of the commands that may be late or missing, rounded up"
    )
    overruns: TickShare = Field(
        default=0.05, ge=0.0, le=1.0, description="share of the ticks that may be a period or more late"
    )
    length: Seconds = Field(default=100e-3, ge=0.0, description="how late a tick may be")
    grace: Seconds = Field(default=0.5, ge=0.0, description="of wall time at the start, where nothing counts")
    on_overrun: OnOverrun = Field(
        default=OnOverrun.CATCH_UP, description="when ticks are late: hurry, go on at the clock's pace, or end the run"
    )


class Allowed(Part):
    """What a good run may have all the same: a scenario that provokes it says how much of it."""

    refused: int = Field(default=0, ge=0, description="commands that the plant may refuse")
    safe_states: int = Field(default=0, ge=0, description="how often the plant may go to its safe state")
    degraded: int = Field(default=0, ge=0, description="how often alarms may degrade the plant")


def _as_word(value: object) -> object:
    """A word that looks like a number, as 46 of an oil, may be written as one."""
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _rig_part(name: str, entries: dict[str, Entry]) -> Any:
    def field(key: str, entry: Entry) -> tuple[Any, Any]:
        if isinstance(entry, Choice):
            word: Any = Literal[entry.options]
            if all(option.isdigit() for option in entry.options):
                word = Annotated[word, BeforeValidator(_as_word)]
            return word, Field(default=entry.value, description=entry.source)
        if isinstance(entry, Table):
            x, y = (Annotated[float, Measured(unit)] for unit in entry.units)
            return tuple[tuple[x, y], ...], Field(default=entry.value, description=entry.source)
        gauge = entry.unit == "Pa" and not any(word in f"{name}.{key}" for word in NOT_GAUGE)
        unit: Any = Annotated[float, Measured(entry.unit, gauge)]
        return unit, Field(default=entry.value, description=entry.source, ge=entry.low, le=entry.high)

    fields: Any = {key: field(key, entry) for key, entry in entries.items()}
    return create_model(f"Rig_{name}", __base__=Part, **fields)


def _rig_model() -> Any:
    parts: Any = {}
    for name, entries in RIG.items():
        part = _rig_part(name, entries)
        parts[name] = (part, Field(default_factory=part))
    text = "Numbers of the rig to change; each has a default with its source."
    return create_model("Rig", __base__=Part, __doc__=text, **parts)


if TYPE_CHECKING:
    RigParts = Any
else:
    RigParts = _rig_model()


def _rig() -> Any:
    model: Any = RigParts
    return model.model_validate({})


class Scenario(Part):
    """One run: the rig, where it starts, how it is controlled, and what is expected of it."""

    name: FileName = "unnamed"
    title: Line = ""
    duration: Seconds = Field(default=DURATION, gt=0.0)
    seed: int = Field(default=1, ge=0, lt=2**63, description="of the sensor noise, and of the run's identity")
    rig_name: str = Field(
        default="rig", pattern=r"^[A-Za-z0-9_-]+(/[A-Za-z0-9_-]+)*$", description="start of every key"
    )
    start: Start = Start()
    loop: Loop = Loop()
    controller: Controller = Pd()
    reference: Reference
    daq: Daq = Daq()
    real_time: RealTime = RealTime()
    allowed: Allowed = Allowed()
    rig: RigParts = Field(default_factory=_rig)
    timeline: list[Happening] = Field(default=[], description="what happens while it runs, docs/timeline.md")
    safety: Safety = Safety()
    alarm: list[Alarm] = Field(default=[], description="limits that stop the plant, docs/safety.md")
    fault: list[Fault] = Field(default=[], description="what goes wrong, docs/faults.md")
    expect: list[Expectation] = Field(
        default=[], description='such as "overshoot <= 5 %", "limit cycle: none"; or {id, text, band} of a requirement'
    )

    @model_validator(mode="after")
    def _consistent(self) -> "Scenario":
        grid = self.loop.grid()
        ticks = self.duration * NS / grid.daq
        if abs(ticks - round(ticks)) > 1e-6 or ticks < 1:
            raise ValueError(f"duration {self.duration} s is not a whole number of DAQ periods of {grid.daq / NS} s")
        if not 0.0 <= self.start.position <= self.rig.cylinder.stroke:
            raise ValueError(
                f"start.position {self.start.position} m lies outside the stroke, 0 to {self.rig.cylinder.stroke} m"
            )
        if self.controller.follows:
            refuse_far(self.reference.reference(), self.duration, self.rig.cylinder.stroke)
        if self.daq.skew > (most := max(SKEW, self.loop.step / (len(CHANNELS) - 1))):
            raise ValueError(f"daq.skew {self.daq.skew:g} s: at most {most:g} s, so that a scan ends within a step")
        refuse_unknown(self.daq.channels, self.rig_values())
        self.controller.refuse_period(self.loop.sample_period)
        if self.controller.needs_tachometer and not self.daq.tachometer:
            raise ValueError(self.controller.NO_TACHOMETER)
        for expected in self.expected:
            refuse_unread(parse_band(expected.band), self.daq.channels)
        self.reference.reference()
        refuse_unsafe(self)
        try:
            plan(self)
            refuse_powerless(self)
            self._refuse_truth_late()
        except ScenarioError as error:
            raise ValueError(str(error)) from None
        return self

    def _refuse_truth_late(self) -> None:
        """The true state is read past the link, so nobody could say which measurement it belongs to."""
        if self.controller.sees_truth and any(fault.target == "link.measurement" for fault in self.fault):
            raise ScenarioError("fault link.measurement: the law reads the true state, which does not take the link")

    @property
    def expected(self) -> list[Expected]:
        """What is expected of a run."""
        return [Expected(e) if isinstance(e, str) else Expected(e.band, e.id, e.text) for e in self.expect]

    def rig_values(self) -> dict[str, dict[str, Any]]:
        """The rig's numbers and words with this scenario's own in place."""
        found = values(self.rig.model_dump())
        fit_holes(found, (fault.target for fault in self.fault))
        return found

    @property
    def ticks(self) -> int:
        """DAQ periods in the run."""
        return round(self.duration * NS / self.loop.grid().daq)
