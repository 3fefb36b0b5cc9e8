"""The references a scenario can ask for; each makes the pure reference that the controller follows."""

from typing import Annotated, Literal

from pydantic import Field

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


AnyReference = Constant | Step | Square | Ramp | Sine | Chirp | Table
Reference = Annotated[AnyReference, Field(discriminator="kind")]
