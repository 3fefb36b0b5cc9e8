"""A controller that is an FMU of another tool: which of its variables read what, and which one moves the spool."""

from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from pydantic import AfterValidator, Field

from bridge.scenario.controller_base import Base, Scale, parameter_in_si
from bridge.scenario.law_parameters import is_gain
from bridge.scenario.units import si


class Mapped(NamedTuple):
    """A signal, and the unit that the FMU has it in, where the scenario says so."""

    signal: str
    unit: str  # "" for the FMU's own, or SI


class FmuGains(NamedTuple):
    """What a law that is an FMU is given."""

    sample_period: float  # T [s], > 0
    limit: float  # of the spool reference, 0..1
    full_scale: float  # [V], of the valve's input
    parameters: dict[str, float]  # by the names of the FMU


def mapped(text: str) -> Mapped:
    """Of "p2" or "p2 in bar"."""
    signal, _, unit = text.partition(" in ")
    return Mapped(signal.strip(), unit.strip())


def _numbers(values: dict[str, Any]) -> dict[str, Any]:
    for name, value in values.items():
        text = isinstance(value, str) and not is_gain(value) and isinstance(si(value), str)
        if text or isinstance(value, list | dict) or value != value:
            raise ValueError(f"{name} = {value!r}: an FMU takes numbers here; give one, or a text with a unit")
    return values


class Fmu(Base):
    """A controller made by another tool, FMI 2.0 or 3.0 for co-simulation: docs/fmu.md."""

    NO_TACHOMETER: ClassVar[str] = ""

    kind: Literal["fmu"]
    fmu: str = Field(min_length=1, description="file beside the scenario, such as law.fmu")
    inputs: dict[str, str | float] = Field(
        default={},
        description="FMU variable = 'signal', 'signal in unit', or a number; without it those that our own FMUs have",
    )
    output: str = Field(default="spool", description='FMU variable of the spool reference, or variable "in V", "in %"')
    parameters: Annotated[dict[str, Any], AfterValidator(_numbers)] = Field(
        default={}, description="FMU parameter = number; a text with a unit is turned into SI"
    )

    @property
    def reads_channels(self) -> bool:
        return True

    def gains(self, scale: Scale) -> FmuGains:
        """The parameters as plain numbers; the FMU is given no others."""
        numbers = {name: float(parameter_in_si(value, scale)) for name, value in self.parameters.items()}
        return FmuGains(scale.sample_period, self.limit, scale.full_scale, numbers)
