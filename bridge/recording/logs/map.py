"""The map of a log: which column is which signal of a drive, in which unit, with which sign, and how it is carried."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, model_validator

from bridge.errors import UsageError
from bridge.recording.logs.headers import KNOWN, known_unit
from bridge.recording.logs.reading import Reading
from bridge.scenario.fields import Bits, Line, Measured, Part, Seconds
from bridge.scenario.mistakes import lines
from bridge.scenario.units import quantity
from bridge.scenario.untrusted import parsed_toml, text_of

NAME = r"^[A-Za-z]\w{0,99}$"
COMMAND, REFERENCE = "command", "reference"
MOST_SIGNALS = 200


class Method(StrEnum):
    """How a signal is carried to the grid."""

    LINEAR = "linear"  # between the rows around an instant
    PREVIOUS = "previous"  # the last row at or before it: of what is held
    NEAREST = "nearest"


class Time(Part):
    """When the rows were taken."""

    column: Line = Field(default="", description="empty: the times that the file has beside its columns, or `step`")
    unit: Line = Field(default="", description='"s", "ms", "us", "ns", "min", "h", "day"; "text" for dates and times')
    format: Line = Field(default="", description="of dates that ISO 8601 does not know, as Python's strptime has it")
    wrap: float = Field(default=0.0, ge=0.0, description="where the counter begins again, in the column's unit")
    step: Annotated[float, Measured("s")] = Field(default=0.0, ge=0.0, description="from row to row, without a column")
    sort: bool = Field(default=False, description="rows stand in any order, and not only a few of them")


def _unit(text: str) -> str:
    unit = known_unit(text)
    if text and unit is None:
        raise ValueError(f"unit {text!r} is unknown: leave it empty, and give `scale`, SI per unit")
    return unit or ""


class Extra(Part):
    """A column that is kept under a name of its own."""

    column: Line
    unit: Line | None = Field(default=None, description="of the column; none: as its head says")
    scale: float | None = Field(default=None, description="SI per SI of `unit`; per count without a unit")
    offset: float | str = Field(default=0.0, description="is added at the end; SI, or text with a unit")
    sign: Literal[1, -1] = 1
    wrap: float = Field(default=0.0, ge=0.0, description="where a counter begins again, as the column has it")
    delay: Seconds = Field(default=0.0, description="how late the column is: its values belong to earlier instants")
    method: Method | None = Field(default=None, description="linear; of the command previous")
    gap: Seconds | None = Field(default=None, gt=0.0, description="longer holes stay missing; none: as the map says")

    @model_validator(mode="after")
    def _finite(self) -> "Extra":
        if self.unit is not None:
            _unit(self.unit)
        if self.scale is not None and not 0.0 < abs(self.scale) < 1e30:
            raise ValueError(f"scale {self.scale:g}: must be finite and not 0")
        if isinstance(self.offset, float) and not abs(self.offset) < 1e30:
            raise ValueError(f"offset {self.offset:g}: must be finite")
        return self

    @property
    def known_unit(self) -> str | None:
        """The unit in our spelling; None where the map leaves it to the column's head."""
        return None if self.unit is None else _unit(self.unit)


class Signal(Extra):
    """A column that is a signal of the drive, and what is known of its sensor."""

    noise: float | str | None = Field(default=None, description='rms before the converter: SI, "0.1 bar", "0.5 LSB"')
    range: tuple[float | str, float | str] | None = Field(default=None, description="ends of the sensor")
    bits: Bits | None = Field(default=None, ge=1.0, le=32.0, description="of the converter")


class Map(Part):
    """A whole map."""

    rig: Line = Field(description="built-in scenario, or a scenario file beside the map: the drive of the data")
    title: Line = ""
    period: Seconds | None = Field(
        default=None, gt=0.0, description="of the grid; none: the scenario's loop.daq_period"
    )
    gap: Seconds | None = Field(default=None, gt=0.0, description="longer holes stay missing; none: 3 usual intervals")
    log: Reading = Reading()
    time: Time = Time()
    signal: dict[Annotated[str, Field(pattern=NAME)], Signal] = Field(min_length=1, max_length=MOST_SIGNALS)
    extra: dict[Annotated[str, Field(pattern=NAME)], Extra] = Field(default={}, max_length=MOST_SIGNALS)
    scenario: dict[str, Any] = Field(default={}, description="changes of the scenario: start, rig, reference, ...")


def load_map(path: Path) -> Map:
    """A map from its file. Raises UsageError with one line per mistake."""
    return parsed_map(text_of(path), str(path))


def parsed_map(text: str, which: str) -> Map:
    """A map from TOML. Raises UsageError with one line per mistake."""
    try:
        return Map.model_validate(parsed_toml(text))
    except ValidationError as error:
        raise UsageError("\n".join(f"{which}: {line}" for line in lines(error))) from None
    except ValueError as error:
        raise UsageError(f"{which}: cannot be read: {error}") from None


def si_of(value: float | str, si: str, who: str) -> float:
    """A number of a map in SI: plain, or text with a unit. Raises UsageError."""
    try:
        return quantity(value, si, gauge=True)
    except (ValueError, KeyError):
        if isinstance(value, str) and (parts := value.rsplit(None, 1)) and len(parts) == 2 and parts[1] in KNOWN:
            base, unit = KNOWN[parts[1]]
            if base == si:
                return float(parts[0]) * unit.factor + unit.offset
        raise UsageError(
            f"{who}: {value!r} is not a number in {si or 'parts of one'}, with or without its unit"
        ) from None
