"""What a recording is, and how its run went: facts, channels with their rates and gaps, events, metrics."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bridge.errors import UsageError
from bridge.recording.reader import Recording
from bridge.recording.remarks import remarks
from bridge.recording.summary import Summary, summary_of
from bridge.recording.tally import Tally
from bridge.recording.told import events_of
from bridge.recording.verdict import verdict
from bridge.wire.codec import decode
from bridge.wire.messages import SOURCED, TOLD
from controller.grid import NS

PAUSE = 1.5  # periods without a message are a gap
RUN = ("run_id", "mode", "speed", "recorded", "versions", "host")


class ChannelInfo(NamedTuple):
    """One channel."""

    topic: str
    type: str
    messages: int
    first: float  # log time [s]
    last: float
    rate: float | None  # [1/s], by the median of the intervals; None for fewer than three messages
    gaps: int  # intervals longer than 1.5 of the median
    longest: float | None  # interval [s]
    lost: int  # by the sequence


class EventInfo(NamedTuple):
    """One event."""

    time: float  # [s]
    kind: str
    text: str


class RecordingInfo(NamedTuple):
    """What a recording is, and how its run went; None for what it does not say."""

    file: str
    size: int | None  # bytes
    complete: bool  # False: messages are missing that had been recorded
    problems: list[str]  # one sentence each
    notes: list[str]  # what people should know, without being a problem
    scenario: str | None
    title: str | None
    rig: str | None
    run: dict[str, Any]  # facts of RUN that the file carries, by name
    metadata: dict[str, dict[str, Any]]  # all other records of facts
    channels: list[ChannelInfo]
    events: list[EventInfo]
    summary: Summary | None

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        summary = self.summary.plain() if self.summary else {}
        own = {name: getattr(self, name) for name in self._fields[:8]}
        return {
            **own,
            **self.run,
            "metadata": self.metadata,
            "channels": [channel._asdict() for channel in self.channels],
            "events": [event._asdict() for event in self.events],
            "ending": summary.get("ending"),
            **{name: summary.get(name, {}) for name in ("metrics", "timing", "commands", "lost")},
        }


def describe(recording: Recording) -> RecordingInfo:
    """Look through a recording."""
    known = recording.metadata
    run = known.get("run", {})
    scenario = run.get("scenario", {})
    return RecordingInfo(
        file=str(recording.path),
        size=_size(recording.path),
        complete=recording.complete,
        problems=problems(recording),
        notes=remarks(recording),
        scenario=scenario.get("name"),
        title=scenario.get("title"),
        rig=scenario.get("rig_name"),
        run={name: run[name] for name in RUN if name in run} | _law(run),
        metadata={name: values for name, values in known.items() if name not in ("run", "summary")},
        channels=channels(recording),
        events=[_event(event) for event in events_of(recording)],
        summary=summary_of(recording),
    )


def _law(run: dict[str, Any]) -> dict[str, Any]:
    """Of a law of the user's: name, short hash and parameters, as far as it has them."""
    law, parameters = run.get("law"), run.get("scenario", {}).get("controller", {}).get("parameters")
    named = {"law": f"{law['name']}, sha256 {law['sha256'][:12]}"} if law else {}
    return named | ({"parameters": parameters} if parameters else {})


def problems(recording: Recording) -> list[str]:
    """What is not as it should be, one sentence each; empty for a run that ended well."""
    known, found = recording.metadata, []
    recovered = "recovered" in known
    if recording.damage.cut:
        found.append("the run ended badly: the file was cut off; `hydrotwin recover` makes it whole")
    found += recording.damage.words()
    if "refused" in known:
        found.append(
            f"the run ended badly for the recorder: {known['refused']['reason']} at {known['refused']['time']}"
        )
    if recovered:
        found.append("the run ended badly: this file was recovered from one that was cut off")
    if damaged := int(known.get("recovered", {}).get("damaged_chunks", 0)):
        found.append(f"{damaged} damaged chunks were left out in recovery")
    if overflow := known.get("recorder", {}).get("overflow"):
        found.append(f"the disk was too slow: the recorder had no room for {overflow}")
    return found + _verdict(recording)


def _verdict(recording: Recording) -> list[str]:
    known = recording.metadata
    if summary := summary_of(recording):
        try:
            return [f"the run went badly: {fault}" for fault in verdict(summary, recording.scenario())]
        except UsageError:
            return []
    return _unsummed(known) if "run" in known and not recording.damage.cut and "recovered" not in known else []


def _unsummed(known: dict[str, Any]) -> list[str]:
    following = known.get("part_end", {}).get("next")
    return [] if following else ["the run ended badly: the file does not say how"]


def channels(recording: Recording) -> list[ChannelInfo]:
    """Every channel that has messages, in the order of their names."""
    grouped: dict[str, list[Any]] = {}
    for entry in recording.entries:
        grouped.setdefault(entry.topic, []).append(entry)
    losses = _losses(recording)
    return [_channel(recording, topic, grouped[topic], losses) for topic in sorted(grouped)]


def _channel(recording: Recording, topic: str, entries: list[Any], losses: dict[str, int]) -> ChannelInfo:
    times = np.sort(np.array([entry.log_time for entry in entries], dtype=np.int64))
    steps = np.diff(times)
    steps = steps[steps > 0]
    median = float(np.median(steps)) if len(steps) > 1 else None
    facts = recording.channels.get(topic)
    return ChannelInfo(
        topic,
        facts.type if facts else "",
        len(entries),
        float(times[0]) / NS,
        float(times[-1]) / NS,
        NS / median if median else None,
        int(np.sum(steps > PAUSE * median)) if median and topic not in TOLD else 0,
        float(steps.max()) / NS if len(steps) else None,
        losses.get(topic, 0),
    )


def _losses(recording: Recording) -> dict[str, int]:
    """Gaps in the publishers' sequences, as far as the file shows them."""
    tally = Tally(from_start=False)
    for entry in recording.entries:
        if entry.topic == "status":
            continue
        source = decode(entry.data, entry.topic).source if entry.topic in SOURCED else 0
        tally.add(entry.topic, source, entry.sequence)
    return tally.losses()


def _event(event: Any) -> EventInfo:
    return EventInfo(event.stamp / NS, event.kind, event.text)


def _size(path: Path) -> int | None:
    return path.stat().st_size if path.is_file() else None


def plain(value: Any) -> str:
    """A fact in one line."""
    return value if isinstance(value, str) else json.dumps(value)
