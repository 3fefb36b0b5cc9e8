"""The bands of a scenario while it runs: judged by what has come so far, in the time that the scenario lasts."""

from pathlib import Path
from typing import Any

from bridge.errors import UsageError
from bridge.recording.entries import Entry
from bridge.recording.reader import recording
from bridge.recording.summarise import summarise
from bridge.runs.check import judge_run
from bridge.scenario import Scenario
from bridge.wire.messages import CHANNELS_TOPIC, Ending
from controller.grid import NS

NEEDED = ("state", "reference", "event", "signals", CHANNELS_TOPIC)
MOST = 200_000  # messages: of a longer scenario the bands are judged by its beginning
FIRST = 0.5  # [s] of simulated time before anything is said
EACH = 0.1  # of what has passed, from one look to the next: a look costs more the more there is
UNKNOWN = "-"  # how the number of a band begins that cannot be told yet


class Judging:
    """Of one run, seen from its beginning on; of another one nothing is said."""

    def __init__(self, scenario: Scenario, manifest: dict[str, Any]) -> None:
        """manifest: what the plant has said of its run."""
        self.scenario = scenario
        self._manifest = manifest
        self.words = "" if scenario.expect else "the scenario states no band"
        self._entries: list[Entry] = []
        self._begins: int | None = None  # [ns], of the first state
        self._time, self._due = 0.0, FIRST
        self._final = False
        self.found: list[dict[str, Any]] = [_row(expected.words, "", None) for expected in scenario.expected]

    def take(self, entries: list[Entry]) -> None:
        """Keep what bands are judged by."""
        if self._final or self.words:
            return
        self._entries += [e for e in entries if e.topic in NEEDED and e.log_time <= self.scenario.duration * NS]
        stamps = [entry.log_time for entry in entries if entry.topic == "state"]
        if stamps and self._begins is None:
            self._begins = stamps[0]
            if stamps[0] > self.scenario.loop.daq_period * NS:
                self.words = f"not judged: the panel came at {stamps[0] / NS:.3g} s"
        self._time = max(self._time, max(stamps, default=0) / NS)

    def look(self, ended: bool) -> bool:
        """Judge, if it is time to; True when something new is known."""
        if self._final or self.words or (self._time < self._due and not ended) or len(self._entries) < 3:
            return False
        self._final = ended or self._time >= self.scenario.duration or len(self._entries) > MOST
        self._due = min(self._time + max(FIRST, EACH * self._time), self.scenario.duration)
        try:
            self.found = self._judged()
        except (UsageError, ValueError) as error:
            self.words = str(error)
        if self._final:
            self._entries = []
        return True

    def plain(self) -> dict[str, Any]:
        """For the page."""
        return {"words": self.words, "bands": self.found, "until": self._time, "final": self._final}

    def _judged(self) -> list[dict[str, Any]]:
        so_far = recording(Path("live"), sorted(self._entries, key=lambda e: e.log_time), {"run": self._manifest})
        summary = summarise(so_far, self.scenario, {})._replace(ending=Ending.COMPLETE)
        verdicts = judge_run(self.scenario, summary, so_far)
        return [_row(v.words, v.found, None if self._open(v.found) else v.passed) for v in verdicts]

    def _open(self, found: str) -> bool:
        """Can it not be told yet?"""
        return found.startswith(UNKNOWN) and not found[1:2].isdigit() and not self._final


def _row(words: str, found: str, passed: bool | None) -> dict[str, Any]:
    return {"band": words, "found": found, "passed": passed}
