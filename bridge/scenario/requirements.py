"""What is expected of a run: bands, and the requirements that they belong to."""

from typing import Annotated, NamedTuple

from pydantic import Discriminator, Field, Tag

from bridge.scenario.fields import Line, Part


class Requirement(Part):
    """A band that a requirement of somebody's asks for."""

    id: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._:/-]*$", description="of the requirement, such as HYD-012")
    text: Line = Field(default="", description="what it asks for, in its own words")
    band: str = Field(description='such as "overshoot <= 5 %"')


Expectation = Annotated[
    Annotated[str, Tag("band")] | Annotated[Requirement, Tag("requirement")],
    Discriminator(lambda value: "band" if isinstance(value, str) else "requirement"),
]


class Expected(NamedTuple):
    """A band, and the requirement that it belongs to, if one is named."""

    band: str
    id: str = ""
    text: str = ""

    @property
    def words(self) -> str:
        """The band, behind the name of its requirement."""
        return f"{self.id}: {self.band}" if self.id else self.band
