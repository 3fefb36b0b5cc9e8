"""The numbers that are asked of a run, found in its recording."""

from bridge.recording.reader import Recording
from bridge.recording.summary import Summary
from bridge.runs.check import UNKNOWN, Look
from bridge.scenario import Scenario
from bridge.scenario.measures import Measure
from controller.bands import Band
from controller.window import bounds, judge_window


def values_of(
    measures: list[Measure], scenario: Scenario, summary: Summary, recording: Recording
) -> list[float | None]:
    """What was asked for, SI; None where the run has no such number."""
    look = None if all(asked.of_run for asked in measures) else Look(recording, scenario)
    found = [_value(asked, summary, look) for asked in measures]
    return [None if value != value else float(value) for value in found]


def _value(asked: Measure, summary: Summary, look: Look | None) -> float:
    band = asked.band
    if look is None or asked.of_run:
        return getattr(summary.metrics or UNKNOWN, band.metric) if isinstance(band, Band) else float("nan")
    if isinstance(band, Band):
        return getattr(look.metrics(bounds(band, look.moments)), band.metric)
    return judge_window(band, *look.series(band), look.moments).value
