"""Scenarios: what is simulated, controlled and expected, as TOML checked on the way in."""

import difflib
import json
import math
import tomllib
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    WithJsonSchema,
    create_model,
    model_validator,
)

from bridge.bands import parse_band
from bridge.units import UNITS, quantity, split
from controller import reference as references
from controller.law import LAWS
from controller.sampling import NS, Sampling, sampling
from twin.rig import RIG, Number, build, numbers


def measured(unit: str) -> Any:
    """A field that takes a number in SI or a text with a unit."""
    text = f"a number in {unit or 'parts of one'}, or text with a unit: {', '.join(filter(None, UNITS[unit]))}"
    schema = {"anyOf": [{"type": "number"}, {"type": "string"}], "description": text}
    return Annotated[float, BeforeValidator(lambda value: _finite(quantity(value, unit), unit)), WithJsonSchema(schema)]


def _finite(value: float, unit: str) -> float:
    """Only a resistance may be infinite: there it means that nothing passes."""
    if math.isnan(value) or (math.isinf(value) and unit != "Pa s/m^3"):
        raise ValueError(f"{value} is no finite number")
    return value


Seconds, Metres, Speed, Hertz = measured("s"), measured("m"), measured("m/s"), measured("Hz")
Pressure, Fraction = measured("Pa"), measured("")


class Part(BaseModel):
    """Base of all sections: unknown keys are errors, nothing changes after loading."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="strings")


class Start(Part):
    """Where the piston waits, at rest with the valve shut."""

    position: Metres = Field(0.1, description="piston [m], from the lower end")


class Loop(Part):
    """The time grid, and what happens when commands stop."""

    step: Seconds = Field(50e-6, gt=0.0, description="internal step; divides the DAQ period")
    daq_period: Seconds = Field(1e-3, gt=0.0, description="from measurement to measurement")
    sample_period: Seconds = Field(10e-3, gt=0.0, description="of the controller, whole DAQ periods")
    offset: Seconds = Field(0.0, ge=0.0, description="of the first sample, whole DAQ periods")
    delay: Seconds = Field(0.0, ge=0.0, description="from sample to action, whole internal steps")
    command_timeout: Seconds = Field(0.1, gt=0.0, description="silence after which the valve is centred")
    after_timeout: Literal["latch", "resume"] = Field(
        "latch", description="stay safe until reset, or until commands resume"
    )
    viewer_period: Seconds = Field(20e-3, gt=0.0, description="of the standard messages for viewers")

    def grid(self) -> Sampling:
        """The same in nanoseconds; ValueError for what is off the grid."""
        return sampling(self.step, self.daq_period, self.sample_period, self.offset, self.delay)


def _gain(value: object, units: dict[str, str], plain: str) -> str:
    number, unit = (float(value), plain) if isinstance(value, int | float) else split(str(value))
    unit = unit or plain
    if unit not in units:
        near = difflib.get_close_matches(unit, units, n=1, cutoff=0.0)[0]
        raise ValueError(f"{value!r}: unit {unit!r} does not fit here; nearest: {near!r} (valid: {', '.join(units)})")
    return f"{number!r} {unit}"


def _gain_field(units: dict[str, str], plain: str) -> Any:
    schema = {"anyOf": [{"type": "number"}, {"type": "string"}], "description": f"in {plain}, or with {list(units)}"}
    return Annotated[str, BeforeValidator(lambda value: _gain(value, units, plain)), WithJsonSchema(schema)]


GAIN = _gain_field({"V/%": "volt per % of stroke", "1/m": "spool per metre"}, "V/%")
DERIVATIVE = _gain_field({"V s/%": "volt per % of stroke and second", "s/m": "spool per m/s"}, "V s/%")


def _known_law(name: str) -> str:
    if name in LAWS or ":" in name:
        return name
    near = difflib.get_close_matches(name, LAWS, n=1, cutoff=0.0)[0]
    raise ValueError(f"law {name!r} is unknown; nearest: {near!r} (valid: {', '.join(LAWS)}, or module:function)")


class Controller(Part):
    """The control law and its gains."""

    law: Annotated[str, AfterValidator(_known_law)] = Field("pd", description="pd, relay, open-loop, module:function")
    gain: GAIN = Field("1.0 V/%", description="proportional, on the position error")
    derivative: DERIVATIVE = Field("0.0 V s/%", description="on the piston's velocity")
    velocity: Literal["measured", "backward", "filtered"] = Field("measured", description="how the velocity is got")
    filter_time: Seconds = Field(20e-3, ge=0.0, description="lag of the filtered difference")
    limit: Fraction = Field(1.0, gt=0.0, le=1.0, description="saturation of the spool reference")
    compensate_overlap: bool = Field(True, description="jump over the dead band of the valve's lands")


class Constant(Part):
    kind: Literal["constant"]
    value: Metres

    def reference(self) -> references.Reference:
        return references.Constant(self.value)


class Step(Part):
    kind: Literal["step"]
    start: Metres
    end: Metres
    at: Seconds = 1.0

    def reference(self) -> references.Reference:
        return references.Step(self.start, self.end, self.at)


class Square(Part):
    kind: Literal["square"]
    mean: Metres
    amplitude: Metres
    period: Seconds = Field(gt=0.0)
    at: Seconds = 1.0

    def reference(self) -> references.Reference:
        return references.Square(self.mean, self.amplitude, self.period, self.at)


class Ramp(Part):
    kind: Literal["ramp"]
    start: Metres
    end: Metres
    at: Seconds = 1.0
    rate: Speed = Field(gt=0.0)

    def reference(self) -> references.Reference:
        return references.Ramp(self.start, self.end, self.at, self.rate)


class Sine(Part):
    kind: Literal["sine"]
    mean: Metres
    amplitude: Metres
    frequency: Hertz = Field(gt=0.0)
    at: Seconds = 1.0

    def reference(self) -> references.Reference:
        return references.Sine(self.mean, self.amplitude, self.frequency, self.at)


class Chirp(Part):
    kind: Literal["chirp"]
    mean: Metres
    amplitude: Metres
    start_frequency: Hertz = Field(ge=0.0)
    end_frequency: Hertz = Field(ge=0.0)
    at: Seconds = 1.0
    duration: Seconds = Field(gt=0.0)

    def reference(self) -> references.Reference:
        return references.Chirp(
            self.mean, self.amplitude, self.start_frequency, self.end_frequency, self.at, self.duration
        )


class Table(Part):
    kind: Literal["table"]
    csv: str = Field(description="two columns, time_s,position_m: a file's name or the text itself")

    def reference(self) -> references.Reference:
        return references.table_from_csv(self.csv)


Reference = Annotated[Constant | Step | Square | Ramp | Sine | Chirp | Table, Field(discriminator="kind")]


class Daq(Part):
    """The data acquisition card; each of its effects can be switched off."""

    bits: float = Field(12.0, ge=1.0, le=32.0, description="2.2.2")
    position_range: Metres = Field(0.3, gt=0.0, description="0 to this, 2.2.2")
    velocity_range: Speed = Field(1.0, gt=0.0, description="+- this, tachometer, assumed")
    pressure_range: Pressure = Field(250e5, gt=0.0, description="0 to this, assumed")
    noise: float = Field(0.5, ge=0.0, description="LSB rms, assumed; 0 for none")
    skew: Seconds = Field(5e-6, ge=0.0, description="from channel to channel, 2.2.2; 0 for none")
    quantise: bool = True
    clip: bool = True
    tachometer: bool = True


class RealTime(Part):
    """When a real-time run counts as failed."""

    overruns: int = Field(10, ge=0, description="how many late ticks are allowed")
    length: Seconds = Field(50e-3, ge=0.0, description="how late one may be")
    grace: Seconds = Field(0.5, ge=0.0, description="of wall time at the start, where nothing counts")


def _rig_part(name: str, entries: dict[str, Number]) -> Any:
    def entry(number: Number) -> tuple[Any, Any]:
        limits = {"ge": number.low, "le": number.high}
        return measured(number.unit), Field(number.value, description=number.source, **limits)

    fields: dict[str, Any] = {key: entry(number) for key, number in entries.items()}
    return create_model(f"Rig_{name}", __base__=Part, **fields)


RigParts: Any = create_model(
    "Rig",
    __base__=Part,
    __doc__="Numbers of the rig to change; each has a default with its source.",
    **{name: (part := _rig_part(name, entries), Field(default_factory=part)) for name, entries in RIG.items()},
)


class Scenario(Part):
    """One run: the rig, where it starts, how it is controlled, and what is expected of it."""

    name: str = "unnamed"
    title: str = ""
    duration: Seconds = Field(10.0, gt=0.0)
    seed: int = Field(1, ge=0, lt=2**63, description="of the sensor noise, and of the run's identity")
    rig_name: str = Field("rig", pattern=r"^[A-Za-z0-9_-]+(/[A-Za-z0-9_-]+)*$", description="start of every key")
    start: Start = Start()
    loop: Loop = Loop()
    controller: Controller = Controller()
    reference: Reference
    daq: Daq = Daq()
    real_time: RealTime = RealTime()
    rig: RigParts = Field(default_factory=RigParts)
    expect: list[str] = Field([], description='such as "overshoot <= 5 %", "limit cycle: none"')

    @model_validator(mode="after")
    def _consistent(self) -> "Scenario":
        grid = self.loop.grid()
        ticks = self.duration * NS / grid.daq
        if abs(ticks - round(ticks)) > 1e-6 or ticks < 1:
            raise ValueError(f"duration {self.duration} s is no whole number of DAQ periods of {grid.daq / NS} s")
        build(self.numbers(), self.loop.step)
        if not 0.0 <= self.start.position <= self.rig.cylinder.stroke:
            raise ValueError(
                f"start.position {self.start.position} m lies outside the stroke, 0 to {self.rig.cylinder.stroke} m"
            )
        if self.daq.skew * 4 > self.loop.step:
            raise ValueError(f"daq.skew {self.daq.skew} s: a scan must fit in a step, at most {self.loop.step / 4} s")
        for text in self.expect:
            parse_band(text)
        self.reference.reference()
        return self

    def numbers(self) -> dict[str, dict[str, float]]:
        """The rig's numbers with this scenario's own in place."""
        return numbers(self.rig.model_dump())

    @property
    def ticks(self) -> int:
        """DAQ periods in the run."""
        return round(self.duration * NS / self.loop.grid().daq)


class ScenarioError(Exception):
    """A scenario that cannot be used; its text has one line per mistake."""


def names() -> list[str]:
    """The built-in scenarios."""
    return sorted(path.name.removesuffix(".toml") for path in _built_in().iterdir() if path.name.endswith(".toml"))


def _built_in():
    return resources.files("bridge") / "scenarios"


def load(which: str, changes: list[str] | None = None) -> Scenario:
    """A built-in scenario by name, or a TOML (or JSON) file by path, with changes such as "controller.gain=0.4".

    Raises ScenarioError with one line per mistake.
    """
    text, folder = _source(which)
    try:
        data = json.loads(text) if which.endswith(".json") else tomllib.loads(text)
    except ValueError as error:
        raise ScenarioError(f"{which}: cannot be read: {error}") from None
    data.setdefault("name", Path(which).stem)
    for change in changes or []:
        _apply(data, change)
    return check(_with_tables(data, folder), which)


def check(data: dict[str, Any], which: str) -> Scenario:
    """The scenario that plain data describe. Raises ScenarioError with one line per mistake."""
    try:
        return Scenario.model_validate(data)
    except ValidationError as error:
        raise ScenarioError("\n".join(f"{which}: {line}" for line in _lines(error))) from None


def _source(which: str) -> tuple[str, Path]:
    if which in names():
        return (_built_in() / f"{which}.toml").read_text(), Path()
    path = Path(which)
    if path.is_file():
        return path.read_text(), path.parent
    near = difflib.get_close_matches(which, names(), n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise ScenarioError(
        f"{which}: no such scenario or file; {hint}built in: {', '.join(names())}"
    )


def _with_tables(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A reference's CSV file is read here, so that the scenario carries all it needs."""
    reference = data.get("reference")
    if isinstance(reference, dict) and isinstance(name := reference.get("csv"), str) and "\n" not in name:
        path = folder / name
        if not path.is_file():
            raise ScenarioError(f"reference.csv: no file {str(path)!r}")
        return data | {"reference": reference | {"csv": path.read_text()}}
    return data


def _apply(data: dict[str, Any], change: str) -> None:
    key, sign, text = change.partition("=")
    if not sign or not key.strip():
        raise ScenarioError(f"{change!r} is no change; write section.name=value, such as controller.gain=0.4")
    *path, last = key.strip().split(".")
    for name in path:
        data = data.setdefault(name, {})
        if not isinstance(data, dict):
            raise ScenarioError(f"{change!r}: {name!r} is a value, not a section")
    try:
        data[last] = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        data[last] = text.strip()


def _lines(error: ValidationError) -> Iterator[str]:
    for entry in error.errors():
        place = [str(part) for part in entry["loc"]]
        kind, context = entry["type"], entry.get("ctx", {})
        where = ".".join(part for part in place if part not in REFERENCES)
        if kind == "extra_forbidden":
            yield f"{where}: unknown key{_near_key(place)}"
        elif kind == "value_error":
            yield f"{where}: {context['error']}" if where else str(context["error"])
        elif kind in LIMITS:
            limit = context[LIMITS[kind][1]]
            nearest = "any beyond it" if kind in ("greater_than", "less_than") else limit
            yield f"{where}: {entry['input']!r} must be {LIMITS[kind][0]} {limit}; nearest valid: {nearest}"
        elif kind in ("literal_error", "union_tag_invalid"):
            valid = str(context.get("expected") or context.get("expected_tags"))
            words = [word.strip(" '") for word in valid.replace(" or ", ",").split(",")]
            given = str(context.get("tag", entry["input"]))
            near = difflib.get_close_matches(given, words, n=1, cutoff=0.0)
            yield f"{where}: {given!r} is unknown; nearest: {near[0]!r} (valid: {', '.join(words)})"
        else:
            yield f"{where}: {entry['msg'].lower()} (got {entry['input']!r})"


LIMITS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}
REFERENCES = {"constant", "step", "square", "ramp", "sine", "chirp", "table"}


def _near_key(place: list[str]) -> str:
    model: Any = Scenario
    for name in place[:-1]:
        if name in REFERENCES and model is None:
            model = globals()[name.capitalize()]
        else:
            field = model.model_fields.get(name) if model else None
            model = field.annotation if field is not None and hasattr(field.annotation, "model_fields") else None
    valid = list(model.model_fields) if model else []
    near = difflib.get_close_matches(place[-1], valid, n=1, cutoff=0.0)
    return f"; did you mean {near[0]!r}? (valid: {', '.join(valid)})" if near else ""
