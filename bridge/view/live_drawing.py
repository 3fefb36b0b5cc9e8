"""One run as it comes in: batches of messages onto a Rerun stream."""

from collections import deque
from pathlib import Path
from typing import Any

import numpy as np

from bridge.recording.entries import Entry
from bridge.recording.frames import Frames, frames
from bridge.recording.inbox import WATCHED
from bridge.recording.own_signals import own_units
from bridge.recording.reader import Recording, recording
from bridge.recording.shown import line_ends
from bridge.recording.verdicts import Said, verdicts_of
from bridge.scenario.channels import layout_of
from bridge.view import length_time
from bridge.view.content import begin, scene_of, send_curve, send_events, style
from bridge.view.curves import CURVES, LIVE, chosen, samples
from bridge.view.followed import columns_of
from bridge.view.layout import layout
from bridge.view.rig.eyes import eyes_of
from bridge.view.rig.motion import move
from bridge.view.rig.scene import stand
from bridge.wire.messages import ESTIMATE, HEALTH, EventKind, Mode
from controller.grid import NS

SPAN = 10.0  # [s], of the maps and curves
REDRAWN = 0.5  # [s] of simulated time, from map to map: they are the larger part of what Rerun gets


class Drawing:
    """A stream that a run is drawn on."""

    def __init__(self, stream: Any, manifest: dict[str, Any], bare: bool) -> None:
        self.stream = stream
        self.run_id = int(manifest["run_id"])
        self.seconds = 0.0  # simulated time drawn
        self.over = False  # the plant has said that the run has ended
        self._head = recording(Path("live"), [], {"run": manifest})
        scenario = self._head.scenario()
        self._layout = layout_of(scenario)
        self._scene = scene_of(scenario)
        self._profiles: deque[Any] = deque(maxlen=max(2, round(SPAN / scenario.loop.viewer_period)))
        self._states: list[Entry] = []
        self._drawn = -NS  # [ns], when the maps were drawn
        self._units: dict[str, str] = {}  # of what the law logs, once it does
        self._followed: set[str] = set()  # topics of a follower that have come
        self._said: Said | None = None  # the latest verdict on the rig's health
        self._own = chosen(self._layout, {})
        self._bare = bare
        topics = {*WATCHED} if manifest["mode"] == Mode.REALTIME else {*WATCHED} - {"timing"}
        self._pictures = {curve.picture for curve in CURVES if curve.topic in topics}
        self._begin()

    def _begin(self) -> None:
        begin(self.stream, self._head)
        self._make_room()
        stand(self.stream, self._scene)
        for pipe, described in enumerate(self._scene.pipes):
            ends = line_ends(self._scene.values)[pipe]
            length_time.frame(self.stream, pipe, described.length, -SPAN, 0.0, "time before now [s]", ends)

    def add(self, entries: list[Entry]) -> None:
        """Draw a batch."""
        batch = recording(self._head.path, entries, self._head.metadata)
        self._draw_curves(batch)
        verdicts = verdicts_of(batch, self._said)
        self._said = verdicts[-1] if verdicts else self._said
        send_events(self.stream, batch, verdicts)
        self.over = self.over or any(event.kind == EventKind.ENDED for event in batch.messages("event"))
        self._draw_rig(entries)

    def _draw_curves(self, batch: Recording) -> None:
        units = self._units or (own_units(batch) if batch.counts.get("signals") else {})
        there = self._followed | ({ESTIMATE, HEALTH} & {*batch.counts})
        if (units, there) != (self._units, self._followed):
            self._units, self._followed = units, there
            self._own = chosen(self._layout, units, there)
            self._make_room()
        curves = [*CURVES, *self._own.curves]
        columns = {topic: columns_of(batch, topic) for topic in {curve.topic for curve in curves} & set(batch.counts)}
        for curve in curves:
            if curve.field in columns.get(curve.topic, ()):
                stamps, values = samples(curve, columns[curve.topic])
                if len(stamps):
                    send_curve(self.stream, curve, stamps, values)
        if "state" in columns:
            self.seconds = float(columns["state"]["stamp"][-1]) / NS

    def _make_room(self) -> None:
        """Lay the pictures out; of what law and follower say the first of their messages tells what there is."""
        style(self.stream, self._own.curves)
        shown, titles = self._pictures | set(self._own.titles), self._own.titles
        eyes = eyes_of(self._scene)
        self.stream.send_blueprint(layout(shown, LIVE, follow=SPAN, bare=self._bare, own=titles, eyes=eyes))

    def _draw_rig(self, entries: list[Entry]) -> None:
        """Frames need a profile and the state of its tick, which may have come with the batch before."""
        states, lines = ([e for e in entries if e.topic == topic] for topic in ("state", "lines"))
        if lines:
            shown = frames(recording(self._head.path, [*self._states, *states, *lines], {}))
            move(self.stream, self._scene, shown)
            if len(shown.stamps):
                self._draw_maps(shown)
        self._states = states or self._states

    def _draw_maps(self, shown: Frames) -> None:
        self._profiles.extend(shown.pressure)
        latest = int(shown.stamps[-1])
        if latest - self._drawn < REDRAWN * NS or len(self._profiles) < 2:
            return
        self._drawn = latest
        missing = (self._profiles.maxlen or 0) - len(self._profiles)
        history = np.stack([*[np.full_like(self._profiles[0], np.nan)] * missing, *self._profiles])
        for pipe in range(history.shape[1]):
            length_time.draw_at(self.stream, pipe, history[:, pipe], latest)
