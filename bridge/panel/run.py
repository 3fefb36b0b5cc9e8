"""One run as the panel has seen it: curves, picture, events, safety, timing, estimates and health."""

import math
from typing import Any

import numpy as np

from bridge.panel.judging import Judging
from bridge.panel.plots import DIGITS, key_of, plots_of
from bridge.panel.rig import Rig, told
from bridge.panel.series import Points, Rows, Series, dtype_of, thinned
from bridge.panel.words import estimate_words, event_words, health_words, units_logged
from bridge.recording.entries import Entry
from bridge.recording.inbox import run_of
from bridge.recording.own_signals import own_columns
from bridge.scenario import Scenario
from bridge.scenario.channels import layout_of
from bridge.view.curves import Curve
from bridge.wire.codec import decode
from bridge.wire.messages import CHANNELS_TOPIC, ESTIMATE, HEALTH, TOLD
from controller.grid import NS
from twin.topology import CHANNELS, LINES, OBSERVED

FLAT = ("state", "reference", "timing", CHANNELS_TOPIC, ESTIMATE, HEALTH, "measurement")
KEPT = 60.0  # [s] of a run at full rate
MOST = 300_000  # rows of a topic, for cards of up to 5 kHz
EVENTS = 500
STATE = (*OBSERVED, "reference")
PAIRS = 3  # stretches of a frame, each with its least and greatest value
DETAIL = 1500  # stretches of what a page asks for


class Run:
    """From its first message on, or from when the panel came."""

    def __init__(self, rig: Rig, scenario: Scenario | None = None) -> None:
        """scenario: of a run that goes on past its duration, as its bands are to be judged."""
        self.rig = rig
        self.scenario = scenario or rig.scenario
        self.judging = Judging(self.scenario, rig.manifest)
        self.events: list[dict[str, Any]] = []
        self.status: dict[str, dict[str, Any]] = {}  # the newest of each role
        self.time = 0.0  # [s] of simulated time
        self.logged: dict[str, str] = {}  # signals of the law, and their units
        self._show()
        self._series = {
            topic: Series(dtype_of(topic, layout_of(self.scenario)), self._keeps()) for topic in self._flat()
        }

    def take(self, entries: list[Entry], seen: bool = True) -> dict[str, Any]:
        """What a page is to be told of new messages; seen: is there any that shows curves and picture?"""
        own = [entry for entry in entries if run_of(entry) == self.rig.run_id]
        by_topic: dict[str, list[Entry]] = {}
        for entry in own:
            by_topic.setdefault(entry.topic, []).append(entry)
        self.judging.take(own)
        events = [event for topic in TOLD for event in self._take_events(by_topic.get(topic, []), topic)]
        for entry in by_topic.get("status", []):
            self._take_status(decode(entry.data, "status"))
        rows = {topic: series.add(by_topic.get(topic, [])) for topic, series in self._series.items()}
        points = {topic: self._points(topic, found, PAIRS) for topic, found in rows.items() if len(found) and seen}
        if by_topic.get("signals"):
            points["signals"] = self._take_signals(by_topic["signals"])
        for found in rows.values():
            if len(found):
                self.time = max(self.time, float(found["stamp"][-1]) / NS)
        return {
            "curves": {topic: plain for topic, plain in points.items() if plain},
            "lines": self._profile(by_topic.get("lines", [])) if seen else None,
            "now": _now(rows) if seen else None,
            **{name: words for name, words in _known(rows).items() if words},
            **({"events": events} if events else {}),
        }

    def detail(self, begin: float, end: float) -> dict[str, Any]:
        """The curves from one time to another [s], as finely as they are kept and a page can show."""
        found = {topic: series.between(begin, end) for topic, series in self._series.items()}
        curves = {topic: self._points(topic, rows, DETAIL) for topic, rows in found.items() if len(rows)}
        return {topic: plain for topic, plain in curves.items() if plain}

    def timing(self) -> dict[str, float]:
        """Of the last 10 s: percentiles of the lateness and of the round trip [s] of wall time."""
        rows = self._series["timing"].between(self.time - 10.0, self.time)
        if not len(rows):
            return {}
        trips = rows["round_trip"][rows["round_trip"] >= 0]
        late = np.percentile(rows["lateness"], [50, 99, 100]) / NS
        found = dict(zip(("late_p50", "late_p99", "late_max"), late.tolist(), strict=True))
        return found | ({"trip_p50": float(np.median(trips)) / NS} if len(trips) else {})

    def _flat(self) -> list[str]:
        return [topic for topic in FLAT if topic != CHANNELS_TOPIC or self.scenario.daq.channels]

    def _keeps(self) -> int:
        return min(MOST, round(KEPT / self.scenario.loop.daq_period))

    def _show(self) -> None:
        """Which curves there are, by topic, each once."""
        self.plots = plots_of(self.scenario, self.logged)
        self._curves: dict[str, dict[str, Curve]] = {}
        for curve in (curve for plot in self.plots for curve in plot.curves):
            self._curves.setdefault(curve.topic, {})[key_of(curve)] = curve

    def _points(self, topic: str, rows: Rows, stretches: int) -> dict[str, Any]:
        curves = list(self._curves.get(topic, {}).values())
        if topic == "timing":
            rows = rows.copy()
            rows["round_trip"][rows["round_trip"] < 0] = 0
        points = thinned(rows, [curve.field for curve in curves], stretches)
        return _plain(points, curves) if curves else {}

    def _take_signals(self, entries: list[Entry]) -> dict[str, Any]:
        messages = [decode(entry.data, "signals") for entry in entries]
        if not self.logged:
            self.logged = units_logged(messages[0])
            self._show()
        columns = own_columns(messages)
        time = np.asarray(columns["stamp"]) / NS
        curves = [curve for curve in self._curves.get("signals", {}).values() if curve.field in columns]
        if not curves:  # another controller logs other signals, or none
            return {}
        return _plain(Points(time, np.stack([columns[curve.field] for curve in curves], axis=1)), curves)

    def _take_events(self, entries: list[Entry], topic: str) -> list[dict[str, Any]]:
        found = [event_words(decode(entry.data, topic)) for entry in entries]
        self.events = [*self.events, *found][-EVENTS:]
        return found

    def _take_status(self, status: Any) -> None:
        self.rig.heed(status)
        self.status[status.role] = told(status)

    def _profile(self, entries: list[Entry]) -> list[list[float]] | None:
        """Pressures [Pa] along each line, at the latest instant."""
        if not entries:
            return None
        line = decode(entries[-1].data, "lines")
        return np.asarray(line.pressure).reshape(LINES, -1).round(-3).tolist()


def _plain(points: Points, curves: list[Curve]) -> dict[str, Any]:
    """For the page: a list of times, and one of values for each curve."""
    values = np.round(points.values * [curve.scale for curve in curves], DIGITS)
    columns = values.T.tolist()
    if np.isnan(values).any():
        columns = [[None if value != value else value for value in column] for column in columns]
    return {"t": np.round(points.time, 6).tolist(), "v": dict(zip(map(key_of, curves), columns, strict=True))}


def _now(rows: dict[str, Rows]) -> dict[str, float | None] | None:
    """The latest of what is true, else of what is estimated, else of what the card has read; SI, by the true names."""
    for topic in ("state", ESTIMATE):
        if len(rows[topic]):
            names = [name for name in rows[topic].dtype.names or () if name in STATE]
            return {name: _finite(rows[topic][name][-1]) for name in names}
    card = rows["measurement"]
    return {channel.reads: _finite(card[name][-1]) for name, channel in CHANNELS.items()} if len(card) else None


def _finite(value: Any) -> float | None:
    return float(f"{value:.6g}") if math.isfinite(value) else None


def _known(rows: dict[str, Rows]) -> dict[str, Any]:
    estimates, health = rows[ESTIMATE], rows[HEALTH]
    return {
        "estimate": estimate_words(estimates[-1]) if len(estimates) else None,
        "health": health_words(health[-1]) if len(health) else None,
    }
