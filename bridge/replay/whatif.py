"""`hydrotwin whatif`: futures from an estimate, judged by bands."""

import math
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bridge.errors import UsageError
from bridge.loop.ahead import Past, Question, changes_of, look_ahead
from bridge.loop.follower import FollowerSide
from bridge.processes.listening import Heard
from bridge.recording.columns import sine_of
from bridge.recording.imported import is_measured
from bridge.recording.reader import read
from bridge.scenario import Scenario
from bridge.scenario.bands import METRICS, parse_band
from bridge.scenario.tunable import in_si, tunable
from bridge.wire.codec import decode
from controller.bands import WHOLE, Band, Metrics, judge
from controller.grid import NS
from controller.metrics import measure
from twin.estimation.settings import Settings

SHARES = {"low": 5.0, "median": 50.0, "high": 95.0}  # percentiles of the futures
MEMORY = 1 * NS  # of measurements before now that a law may have seen
OF_A_STEP = {"rise_time": "overshoot", "settling_time": "overshoot"}  # without a value also where it never settles
ORDER = {"command": 0, "event": 1, "measurement": 2}


class Kept(NamedTuple):
    """In how many futures a band is kept."""

    band: str
    kept: int
    futures: int


class Verdict(NamedTuple):
    """What would happen."""

    time: float  # of the estimate [s]
    horizon: float  # [s]
    changes: Mapping[str, Any]
    tried: str  # the same for people, in SI
    metrics: dict[str, dict[str, float]]  # low, median, high; of those that every future has
    bands: list[Kept]
    risk: float  # share of futures that may break a band
    took: float  # [s] of wall time

    @property
    def passed(self) -> bool:
        """Is each band kept in enough futures?"""
        return all(kept.futures - kept.kept <= self.risk * kept.futures for kept in self.bands)

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return self._asdict() | {"bands": [kept._asdict() for kept in self.bands], "passed": self.passed}


def from_file(path: Path, at: int | None, settings: Settings) -> Heard:
    """The estimate of a recording at a time [ns], None for its end. Raises UsageError where there is none."""
    recording = read(path)
    scenario = recording.scenario()
    if is_measured(recording):
        raise UsageError(
            f"{path}: a log that was imported has no control law, so nobody knows what would have followed"
        )
    end = max((entry.log_time for entry in recording.entries if entry.topic == "measurement"), default=0)
    if at is not None and at > end:
        raise UsageError(f"--at {at / NS:g} s: {path} ends at {end / NS:g} s")
    side, past = FollowerSide(scenario, settings), Past([], [])
    entries = sorted(
        (entry for entry in recording.entries if entry.topic in ORDER and (at is None or entry.log_time <= at)),
        key=lambda entry: (entry.log_time, ORDER[entry.topic]),
    )
    for entry in entries:
        message = decode(entry.data, entry.topic)
        if entry.topic == "command":
            side.take(message)
        elif entry.topic == "event":
            side.heed(message)
            past.changes.extend(changes_of(message))
        else:
            side.hear(message)
            past.measurements.append(message)
    side.finish()
    if side.latest is None:
        raise UsageError(f"{path}: no measurement by then that says where the piston is")
    return Heard(side, scenario, past)


def what_if(heard: Heard, changes: Mapping[str, Any], horizon: int, bands: Sequence[str], risk: float) -> Verdict:
    """The futures under some changes, judged. Raises UsageError, ScenarioError."""
    parsed = [band_of(text) for text in bands]
    if horizon < heard.side.grid.daq:
        raise UsageError(f"--horizon {horizon / NS:g} s: at least one scan, {heard.side.grid.daq / NS:g} s")
    before = time.perf_counter()
    recent = [m for m in heard.past.measurements if m.stamp >= heard.side.now - MEMORY]
    futures = look_ahead(heard.side, heard.scenario, Past(recent, heard.past.changes), Question(changes, horizon))
    with np.errstate(invalid="ignore"):
        found = [measure(signals, frequency=sine_of(heard.scenario), moved=True) for signals in futures]
    for text, band in zip(bands, parsed, strict=True):
        _refuse_without_answer(text, band, found, horizon)
    kept = [
        Kept(text, sum(judge(metrics, [band])[0].passed for metrics in found), len(found))
        for text, band in zip(bands, parsed, strict=True)
    ]
    took = time.perf_counter() - before
    tried = ", ".join(_words(name, value, heard.scenario) for name, value in changes.items())
    return Verdict(heard.side.now / NS, horizon / NS, dict(changes), tried, _spread(found), kept, risk, took)


def _words(name: str, value: Any, scenario: Scenario) -> str:
    entry = tunable(name, scenario)
    return f"{name} = {in_si(value, entry, scenario):.4g} {entry.unit}".rstrip()


def band_of(text: str) -> Band:
    """A band that a look ahead can be judged by. Raises UsageError."""
    try:
        band = parse_band(text)
    except ValueError as error:
        raise UsageError(f"--{error}") from None
    if not isinstance(band, Band) or (band.begin, band.end) != WHOLE:
        raise UsageError(f"--expect {text!r}: a band of a metric over the whole horizon, such as 'overshoot <= 5 %'")
    return band


def _refuse_without_answer(text: str, band: Band, found: list[Metrics], horizon: int) -> None:
    telling = OF_A_STEP.get(band.metric, band.metric)
    if not any(math.isfinite(getattr(metrics, telling)) for metrics in found):
        raise UsageError(
            f"--expect {text!r}: not applicable to any of these futures of {horizon / NS:g} s; a limit cycle needs a "
            "reference that rests, overshoot and settling need a step: ask for 'valve travel' or 'max error'"
        )


def _spread(found: list[Metrics]) -> dict[str, dict[str, float]]:
    spread = {}
    for name in METRICS:
        values = np.array([getattr(metrics, name) for metrics in found])
        if np.isfinite(values).all():
            spread[name] = {word: float(np.percentile(values, share)) for word, share in SHARES.items()}
    return spread
