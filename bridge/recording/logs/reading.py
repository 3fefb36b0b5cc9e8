"""How a log is to be read, where the file itself leaves that open: the section [log] of a map."""

from typing import Literal

from pydantic import Field

from bridge.scenario.fields import Line, Part

MISSING = ("", "nan", "-nan", "na", "n/a", "#n/a", "#nv", "null", "none", "-", "--", "inf", "-inf", "+inf")  # any case


class Reading(Part):
    """What the readers of text take from it; everything is found by itself where it is not given."""

    encoding: Line = Field(default="", description='such as "utf-8", "cp1252", "utf-16"')
    delimiter: Line | Literal["\t"] = Field(default="", max_length=4, description="between cells; tab, or a sign")
    decimal: Literal["", ".", ","] = Field(default="", description="sign before decimals")
    header: int = Field(default=0, ge=0, le=10_000, description="line with the names, from 1; 0: found")
    units: int = Field(default=0, ge=0, le=10_000, description="line with the units, from 1; 0: found")
    missing: list[Line] = Field(default=[], max_length=50, description="further words for a missing value")
    group: Line = Field(default="", description="of a file that holds several tables: the one to read")

    def is_missing(self, cell: str) -> bool:
        """Does a cell stand for nothing?"""
        word = cell.strip()
        return word.lower() in MISSING or word in self.missing


def found(reading: "Reading | None") -> "Reading":
    """The reading of a map, or one that leaves everything open."""
    return reading or Reading()
