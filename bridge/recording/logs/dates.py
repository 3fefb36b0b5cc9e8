"""Dates and times of day as text: ISO 8601 with time zones, German dates, times of day alone; in nanoseconds."""

import re
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError

NS = 1_000_000_000
DAY = 86400 * NS
NONE = np.iinfo(np.int64).min  # of an empty cell
CLOCK = r"(?P<h>\d{1,2}):(?P<min>\d\d)(?::(?P<s>\d\d)(?:[.,](?P<part>\d{1,12}))?)?"
ZONE = r"\s*(?P<zone>Z|z|UTC|GMT|[+-]\d\d(?::?\d\d)?)?"
ISO = r"(?P<y>\d{4})[-/](?P<m>\d\d?)[-/](?P<d>\d\d?)"
GERMAN = r"(?P<d2>\d\d?)\.(?P<m2>\d\d?)\.(?P<y2>\d{4})"
DATE = re.compile(rf"^(?:{ISO}|{GERMAN})[T ]+{CLOCK}{ZONE}$")
OF_DAY = re.compile(rf"^{CLOCK}$")
LIKE = "2026-03-01T12:30:00.125Z, 2026-03-01 12:30:00.125+01:00, 01.03.2026 12:30:00,125, or 12:30:00.125"


def nanoseconds_of(texts: list[str], form: str, who: str) -> NDArray[np.int64]:
    """Nanoseconds since 1970, of times of day since midnight (a day more behind each); NONE for an empty cell."""
    read = _by_format(form) if form else _stamp
    found = np.full(len(texts), NONE, np.int64)
    for row, text in enumerate(texts):
        if not text.strip():
            continue
        try:
            found[row] = read(text.strip())
        except (ValueError, OverflowError):
            wanted = f"as [time] format {form!r} wants it" if form else f"such as {LIKE}; say [time] format for others"
            raise UsageError(f"{who}: row {row + 1} holds {text[:40]!r}, not a date or time {wanted}") from None
    return found if form or not any(map(OF_DAY.match, map(str.strip, texts[:1]))) else _over_midnight(found)


def _by_format(form: str):
    def read(text: str) -> int:
        return _since_1970(datetime.strptime(text, form), 0)

    return read


def _stamp(text: str) -> int:
    if match := OF_DAY.match(text):
        return _of_day(match)
    match = DATE.match(text)
    if match is None:
        raise ValueError(text)
    year, month, day = (int(match[name] or match[f"{name}2"]) for name in ("y", "m", "d"))
    midnight = datetime(year, month, day, tzinfo=UTC)
    return _since_1970(midnight, _of_day(match)) - _zone(match["zone"] or "")


def _of_day(match: re.Match[str]) -> int:
    hours, minutes, seconds = (int(match[name] or 0) for name in ("h", "min", "s"))
    if hours > 24 or minutes > 59 or seconds > 60:
        raise ValueError(match[0])
    part = (match["part"] or "0")[:9].ljust(9, "0")
    return (hours * 3600 + minutes * 60 + seconds) * NS + int(part)


def _zone(text: str) -> int:
    if text[:1] not in ("+", "-"):
        return 0
    digits = text[1:].replace(":", "").ljust(4, "0")
    return (1 if text[0] == "+" else -1) * (int(digits[:2]) * 3600 + int(digits[2:]) * 60) * NS


def _since_1970(moment: datetime, further: int) -> int:
    whole = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
    apart = whole - datetime(1970, 1, 1, tzinfo=UTC)
    return (apart.days * 86400 + apart.seconds) * NS + apart.microseconds * 1000 + further


def _over_midnight(stamps: NDArray[np.int64]) -> NDArray[np.int64]:
    """Times of day that fall by more than half a day are those of the next one."""
    known = stamps != NONE
    days = np.cumsum(np.diff(stamps[known], prepend=stamps[known][:1]) < -DAY // 2)
    found = stamps.copy()
    found[known] += days * DAY
    return found
