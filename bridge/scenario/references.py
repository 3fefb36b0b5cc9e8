"""The references a scenario can ask for; each makes the pure reference that the controller follows."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from bridge.scenario.fields import Hertz, Metres, Part, Seconds, Speed
from controller import reference as references


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


class Live(Part):
    """Targets come while the loop runs: anybody may publish them on <rig>/target."""

    kind: Literal["live"]
    value: Metres = Field(description="before the first target [m]")
    rate: Speed = Field(default=0.2, gt=0.0, description="at which the reference goes to a target")
    low: Metres = Field(default=0.0, description="targets below count as this")
    high: Metres = Field(default=0.27, description="targets above count as this")
    timeout: Seconds = Field(default=0.5, gt=0.0, description="silence after which the reference stays where it is")

    @model_validator(mode="after")
    def _ordered(self) -> "Live":
        if not self.low <= self.value <= self.high:
            raise ValueError(f"value {self.value:g} m must lie between low {self.low:g} m and high {self.high:g} m")
        return self

    def reference(self) -> references.Reference:
        return references.Constant(self.value)


AnyReference = Constant | Step | Square | Ramp | Sine | Chirp | Table | Live
Reference = Annotated[AnyReference, Field(discriminator="kind")]
