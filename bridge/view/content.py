"""What a recording becomes in Rerun: curves and events on simulated time, and how they are laid out."""

from pathlib import Path
from typing import Any

import numpy as np

from bridge.recording.reader import Recording
from bridge.scenario import ScenarioError
from bridge.view.curves import PICTURES, Curve, Drawn, draw, span

APPLICATION = "hydrotwin"
TIMELINE = "sim_time"
EVENTS = "events"
GRAVE = ("late", "refused", "safe")  # kinds of events that a run should not have
SHARES = {
    "position_mm": 3,
    "pressure_bar": 4,
    "valve": 2.5,
    "wall_time_us": 2.5,
    EVENTS: 3,
    "relief_l_min": 2,
    "relief_um": 2,
    "vapour_cm3": 2,
}  # of the height


def write(recording: Recording, path: Path) -> Path:
    """Write a recording's curves, events and layout as a Rerun file and return its path."""
    import rerun as rr

    if path.suffix != ".rrd":
        raise ScenarioError(f"{path}: Rerun knows its files by their ending; name it {path.with_suffix('.rrd')}")
    stream = rr.RecordingStream(APPLICATION)
    try:
        stream.save(path)
    except RuntimeError as error:
        raise ScenarioError(f"cannot write the view: {error}") from None
    send(stream, recording)
    return path


def send(stream: Any, recording: Recording) -> None:
    """Send everything to where the stream leads, and close it."""
    curves = draw(recording)
    stream.send_blueprint(_layout(curves))
    stream.send_recording_name(_title(recording))
    for curve in curves:
        _send_curve(stream, *curve)
    _send_events(stream, recording)
    stream.flush()
    stream.disconnect()


def _title(recording: Recording) -> str:
    scenario = recording.metadata.get("run", {}).get("scenario", {})
    return ": ".join(filter(None, (recording.path.stem, scenario.get("title") or scenario.get("name"))))


def _send_curve(stream: Any, curve: Curve, stamps: Any, values: Any) -> None:
    import rerun as rr

    mode = "StepAfter" if curve.held else "Linear"
    style = rr.SeriesLines(colors=curve.colour, widths=curve.width, names=curve.label, interpolation_mode=mode)
    stream.log(curve.entity, style, static=True)
    stream.send_columns(curve.entity, [_time(stamps)], rr.Scalars.columns(scalars=values))


def _send_events(stream: Any, recording: Recording) -> None:
    import rerun as rr

    events = recording.messages("event")
    if not events:
        return
    text = [f"{event.kind}: {event.text}" for event in events]
    level = ["WARN" if event.kind in GRAVE else "INFO" for event in events]
    stamps = np.array([event.stamp for event in events])
    stream.send_columns(EVENTS, [_time(stamps)], rr.TextLog.columns(text=text, level=level))


def _time(stamps: Any) -> Any:
    import rerun as rr

    return rr.TimeColumn(TIMELINE, duration=stamps.astype("timedelta64[ns]"))


def _layout(curves: list[Drawn]) -> Any:
    """The pictures that have a curve, one above the other on a common time axis, and the events below."""
    import rerun.blueprint as rrb

    names = [name for name in PICTURES if any(drawn.curve.picture == name for drawn in curves)]
    columns = rrb.TextLogColumns(text_log_columns=["LogLevel", "Body"])
    log = rrb.TextLogView(origin=EVENTS, name="events", columns=columns)
    views = [_picture(name, curves) for name in names]
    rows = rrb.Vertical(*views, log, row_shares=[SHARES[name] for name in (*names, EVENTS)])
    panel = rrb.TimePanel(timeline=TIMELINE, play_state="paused", state="collapsed")
    return rrb.Blueprint(rows, panel, collapse_panels=True)


def _picture(name: str, curves: list[Drawn]) -> Any:
    import rerun.blueprint as rrb

    return rrb.TimeSeriesView(
        origin=name,
        name=PICTURES[name],
        axis_x=rrb.TimeAxis(link="LinkToGlobal"),
        axis_y=rrb.ScalarAxis(range=span(curves, name)),
        plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop),
    )
