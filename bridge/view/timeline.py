"""The one timeline of the view: simulated time."""

from typing import Any

TIMELINE = "sim_time"


def time_column(stamps: Any) -> Any:
    """Stamps [ns] as a column of times."""
    import rerun as rr

    return rr.TimeColumn(TIMELINE, duration=stamps.astype("timedelta64[ns]"))
