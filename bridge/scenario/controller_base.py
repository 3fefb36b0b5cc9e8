"""What controllers of all kinds have in common, and what turns a scenario's gains into those of a law."""

from typing import Any, ClassVar, Literal, NamedTuple

from pydantic import Field

from bridge.scenario.fields import Fraction, Part, Seconds
from bridge.scenario.law_parameters import is_gain
from bridge.scenario.units import si, split
from controller import law as laws

Velocity = Literal["measured", "backward", "filtered"]


class Scale(NamedTuple):
    """What turns a scenario's gains into those of a law."""

    stroke: float  # [m]
    full_scale: float  # [V], of the valve's input
    overlap: float  # of the valve's lands, share of the travel
    sample_period: float  # [s]

    def per_metre(self, text: str) -> float:
        """A gain in volts per % of the stroke, or in SI already: 1/m; of a derivative s/m, of an integral 1/(m s)."""
        number, unit = split(text)
        return laws.per_metre(number, self.stroke, self.full_scale) if unit.startswith("V") else number


class Base(Part):
    """What all controllers have in common."""

    NO_TACHOMETER: ClassVar[str] = (
        "controller.velocity 'measured' needs a tachometer: set daq.tachometer = true, "
        "or controller.velocity = 'backward' or 'filtered'"
    )

    kind: Any
    limit: Fraction = Field(default=1.0, gt=0.0, le=1.0, description="saturation of the spool reference")

    @property
    def sees_truth(self) -> bool:
        """Is the law given the true state?"""
        return False

    @property
    def reads_channels(self) -> bool:
        """Is the law given the further channels of the card?"""
        return False

    @property
    def follows(self) -> bool:
        """Does the reference say where the piston should be?"""
        return True

    @property
    def needs_tachometer(self) -> bool:
        """Is the velocity read from the card?"""
        return False

    @property
    def jumped_share(self) -> float:
        """Of the dead band of the valve's lands, how much is jumped over; 0..1."""
        return 0.0

    def refuse_period(self, period: float) -> None:
        """Raises ValueError for a sample period [s] that the controller cannot have."""


class WithOverlap(Base):
    """A controller that can jump over the dead band of the valve's lands."""

    compensate_overlap: bool = Field(default=False, description="jump over the dead band of the valve's lands")
    overlap_share: Fraction = Field(
        default=1.0, gt=0.0, le=1.0, description="of the overlap that is jumped; below 1 a dead band is left"
    )

    @property
    def jumped_share(self) -> float:
        return self.overlap_share if self.compensate_overlap else 0.0


class WithVelocity(Base):
    """A controller that knows the piston's velocity."""

    velocity: Velocity = Field(default="measured", description="how the velocity is got")
    filter_time: Seconds = Field(default=20e-3, ge=0.0, description="lag of the filtered difference")

    @property
    def needs_tachometer(self) -> bool:
        return self.velocity == "measured"


def parameter_in_si(value: Any, scale: Scale) -> Any:
    """A parameter in SI."""
    if isinstance(value, list):
        return [parameter_in_si(entry, scale) for entry in value]
    if isinstance(value, str):
        return scale.per_metre(value) if is_gain(value) else si(value)
    return value
