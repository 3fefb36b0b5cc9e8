"""What a recording becomes in Rerun: the rig, maps of its pipes, curves and events on simulated time."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bridge.drawing.colours import DARK
from bridge.errors import UsageError
from bridge.recording.changes import changes
from bridge.recording.frames import Frames, frames
from bridge.recording.reader import Recording
from bridge.recording.seen import instants, seen
from bridge.recording.shown import GROUPS, line_ends
from bridge.recording.told import events_of
from bridge.recording.verdicts import Said, verdicts_of
from bridge.recording.words import run_in_words
from bridge.scenario import Scenario
from bridge.scenario.fitted import of_drive
from bridge.view import length_time
from bridge.view.curves import CURVES, Curve, chosen_in, draw, span
from bridge.view.layout import EVENTS, RUN, layout
from bridge.view.rig.eyes import EYES, Eyes, eyes_of
from bridge.view.rig.motion import move
from bridge.view.rig.scene import stand
from bridge.view.rig.stage import Stage, stage
from bridge.view.timeline import time_column
from bridge.wire.messages import COMING, EventKind
from controller.grid import NS
from twin.estimation.hypotheses import Verdict

APPLICATION = "hydrotwin"
CHANGES, MARK = "position_mm/change", DARK["violet"]
GRAVE = (EventKind.LATE, EventKind.REFUSED, *COMING)  # kinds of events that a run should not have


def write(recording: Recording, path: Path) -> Path:
    """Write a recording's view as a Rerun file and return its path."""
    import rerun as rr

    if path.suffix != ".rrd":
        raise UsageError(f"{path}: Rerun knows its files by their ending; name it {path.with_suffix('.rrd')}")
    stream = rr.RecordingStream(APPLICATION)
    try:
        stream.save(path)
    except RuntimeError as error:
        raise UsageError(f"cannot write the view: {error}") from None
    send(stream, recording)
    return path


def send(stream: Any, recording: Recording, bare: bool = False) -> None:
    """Send everything to where the stream leads, and close it; `bare`: to be printed."""
    curves = draw(recording)
    shown = {drawn.curve.picture for drawn in curves}
    own = chosen_in(recording)
    spans = {name: span(curves, name) for name in shown}
    stream.send_blueprint(layout(shown, spans, bare=bare, own=own.titles, eyes=_eyes(recording)))
    begin(stream, recording)
    style(stream, own.curves)
    for curve, stamps, values in curves:
        send_curve(stream, curve, stamps, values)
    send_events(stream, recording, verdicts_of(recording))
    _send_changes(stream, recording)
    _send_rig(stream, recording)
    stream.flush()
    stream.disconnect()


def begin(stream: Any, recording: Recording) -> None:
    """Name the run, style its curves, say what it is."""
    import rerun as rr

    stream.send_recording_name(_title(recording))
    style(stream, _named(CURVES, recording))
    text = rr.TextDocument(run_in_words(recording), media_type=rr.MediaType.MARKDOWN)
    stream.log(RUN, text, static=True)


def _named(curves: Iterable[Curve], recording: Recording) -> Iterable[Curve]:
    """Curves in the words of the drive."""
    if "run" not in recording.metadata:
        return curves
    values = recording.scenario().rig_values()
    return [curve._replace(label=of_drive(curve.label, values)) for curve in curves]


def style(stream: Any, curves: Iterable[Curve]) -> None:
    """Say how curves look."""
    import rerun as rr

    for curve in curves:
        mode = "StepAfter" if curve.held else "Linear"
        looks = rr.SeriesLines(colors=curve.colour, widths=curve.width, names=curve.label, interpolation_mode=mode)
        stream.log(curve.entity, looks, static=True)


def send_curve(stream: Any, curve: Curve, stamps: Any, values: Any) -> None:
    """Send points of a curve."""
    import rerun as rr

    stream.send_columns(curve.entity, [time_column(stamps)], rr.Scalars.columns(scalars=values))


def send_events(stream: Any, recording: Recording, verdicts: Sequence[Said]) -> None:
    """Send a recording's events, and verdicts on the health of its rig, as text."""
    import rerun as rr

    events = [(e.stamp, f"{e.kind}: {e.text}", e.kind in GRAVE) for e in events_of(recording)]
    events += [(said.stamp, f"health: {said.words}", said.verdict > Verdict.HEALTHY) for said in verdicts]
    if not events:
        return
    events.sort(key=lambda event: event[0])
    text = [f"{stamp / NS:9.3f} s  {words}" for stamp, words, _ in events]
    level = ["WARN" if grave else "INFO" for *_, grave in events]
    stamps = np.array([stamp for stamp, *_ in events])
    stream.send_columns(EVENTS, [time_column(stamps)], rr.TextLog.columns(text=text, level=level))


def _send_changes(stream: Any, recording: Recording) -> None:
    """A mark on the piston's curve at each change of a number; what it was stands in the log."""
    import rerun as rr

    changed = changes(recording)
    if not changed or not instants(recording):
        return
    state, stamps = seen(recording), np.array([round(change.time * NS) for change in changed])
    at = np.interp(stamps, state["stamp"], state["position"]) * GROUPS["position"].scale
    stream.log(CHANGES, rr.SeriesPoints(markers="diamond", colors=MARK, marker_sizes=5.0, names="change"), static=True)
    stream.send_columns(CHANGES, [time_column(stamps)], rr.Scalars.columns(scalars=at))


def _send_rig(stream: Any, recording: Recording) -> None:
    """The rig in 3-D and the maps of its pipes; a file without a scenario or a state has none."""
    if "run" not in recording.metadata:
        return
    scene, shown = scene_of(recording.scenario()), frames(recording)
    if not len(shown.stamps):
        return
    stand(stream, scene)
    move(stream, scene, shown)
    for pipe in range(len(scene.pipes)):
        _send_map(stream, pipe, scene, shown)


def _eyes(recording: Recording) -> Eyes:
    return eyes_of(scene_of(recording.scenario())) if "run" in recording.metadata else EYES


def _send_map(stream: Any, pipe: int, scene: Stage, shown: Frames) -> None:
    first, last = length_time.seconds(shown.stamps)
    length = scene.pipes[pipe].length
    length_time.frame(stream, pipe, length, first, last, "simulated time [s]", line_ends(scene.values)[pipe])
    length_time.draw(stream, pipe, shown.pressure[:, pipe])
    length_time.cursor(stream, pipe, shown.stamps)


def scene_of(scenario: Scenario) -> Stage:
    """The stage of a scenario's rig."""
    return stage(scenario.rig_values())


def _title(recording: Recording) -> str:
    scenario = recording.metadata.get("run", {}).get("scenario", {})
    return ": ".join(filter(None, (recording.path.stem, scenario.get("title") or scenario.get("name"))))
