"""One line of a picture of the view."""

from typing import NamedTuple


class Curve(NamedTuple):
    """From which message it comes, and how it looks."""

    picture: str
    name: str
    label: str
    topic: str
    field: str
    scale: float  # from what the message holds (SI, or ns of wall time) to what is shown
    colour: tuple[int, int, int]
    width: float  # [points]
    held: bool = False  # a value is in force until the next one

    @property
    def entity(self) -> str:
        """Where it stands in the viewer."""
        return f"{self.picture}/{self.name}"
