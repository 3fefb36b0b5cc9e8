"""Fields of scenarios that take a number in SI, or text with a unit."""

import math
from typing import Annotated, Any, get_args

from pydantic import AfterValidator, BaseModel, ConfigDict, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from bridge.errors import is_hidden, nearest
from bridge.scenario.units import ABSOLUTE, UNITS, quantity, split
from twin.kept import channel_name


class Part(BaseModel):
    """Base of all sections: unknown keys are errors, nothing changes after loading."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="strings")


def by_kind(union: Any) -> dict[str, type[Part]]:
    """The members of a union, each by the word that its `kind` must be."""
    return {get_args(model.model_fields["kind"].annotation)[0]: model for model in get_args(union)}


class Worded:
    """What stands in an Annotated field: reads the value before pydantic does, and describes itself."""

    description = ""

    def read(self, value: object) -> Any:
        """The value as it is kept; ValueError says what would fit."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"anyOf": [{"type": "number"}, {"type": "string"}], "description": self.description}


class Measured(Worded):
    """A quantity with a unit."""

    def __init__(self, unit: str, gauge: bool = False) -> None:
        """gauge: a gauge pressure, which may be given as an absolute one."""
        self.unit, self.gauge = unit, gauge
        units = ", ".join(filter(None, (*UNITS[unit], *(ABSOLUTE if gauge else ()))))
        self.description = f"a number in {unit or 'parts of one'}, or text with a unit: {units}"

    def read(self, value: object) -> float:
        """In SI. Only a resistance may be infinite: there it means that nothing passes."""
        number = quantity(value, self.unit, self.gauge)
        if math.isnan(number) or (math.isinf(number) and self.unit != "Pa s/m^3"):
            raise ValueError(f"{number} is not a finite number")
        return number


class Share(Measured):
    """A part of one, "2 %" or 0.02; a whole number would once have been a count."""

    def __init__(self, of: str) -> None:
        super().__init__("")
        self.of = of

    def read(self, value: object) -> float:
        """The share, 0 to 1."""
        if isinstance(value, int) and not isinstance(value, bool) and value > 0:
            raise ValueError(f"{value} is not a share of the {self.of}; write a part of them, such as '2 %' or 0.02")
        return super().read(value)


class Gain(Worded):
    """A gain, kept as text: what volts per % are in SI depends on the rig."""

    def __init__(self, volts: str, si: str) -> None:
        self.volts = volts
        self.units = (volts, si)
        self.description = f"a number in {volts}, or text with a unit: {volts}, {si}"

    def read(self, value: object) -> str:
        """The number with its unit."""
        if isinstance(value, bool):
            raise ValueError(f"{value!r} is not a gain; write a number in {self.volts}")
        number, unit = (float(value), "") if isinstance(value, int | float) else split(str(value))
        if not math.isfinite(number):
            raise ValueError(f"{value!r} is not a finite gain")
        unit = unit or self.volts
        if unit not in self.units:
            raise ValueError(f"{value!r}: unit {unit!r} does not fit here{nearest(unit, self.units)}")
        return f"{number!r} {unit}"


LONGEST_NAME = 160  # bytes; a file's name has at most 255


def _one_line(text: str) -> str:
    if any(map(is_hidden, text)):
        raise ValueError(f"{text!r} holds a control character; write one line of text")
    return text


def _file_name(text: str) -> str:
    """A name that recordings can be named after, in a folder of their own at most."""
    parts = text.replace("\\", "/").split("/")
    if text.startswith("/") or not all(part.strip(" .") for part in parts):
        raise ValueError(f"{text!r} would leave the folder of recordings; write a name such as 'step-slow'")
    if len(text.encode()) > LONGEST_NAME:
        raise ValueError(f"{text[:20]!r}... has {len(text.encode())} bytes; a file's name allows {LONGEST_NAME}")
    return text


Line = Annotated[str, AfterValidator(_one_line)]
FileName = Annotated[Line, AfterValidator(_file_name)]
ChannelName = Annotated[str, AfterValidator(channel_name)]
Seconds = Annotated[float, Measured("s")]
Metres = Annotated[float, Measured("m")]
Speed = Annotated[float, Measured("m/s")]
Flow = Annotated[float, Measured("m^3/s")]
Volume = Annotated[float, Measured("m^3")]
Force = Annotated[float, Measured("N")]
Acceleration = Annotated[float, Measured("m/s^2")]
Hertz = Annotated[float, Measured("Hz")]
Pressure = Annotated[float, Measured("Pa", gauge=True)]
Fraction = Annotated[float, Measured("")]
Bits = Annotated[float, Measured("bit")]
LeastBits = Annotated[float, Measured("LSB")]
TickShare = Annotated[float, Share("ticks")]
CommandShare = Annotated[float, Share("commands")]
ProportionalGain = Annotated[str, Gain("V/%", "1/m")]
IntegralGain = Annotated[str, Gain("V/(% s)", "1/(m s)")]
DerivativeGain = Annotated[str, Gain("V s/%", "s/m")]
