"""`hydrotwin follow FILE`: a recording with what a twin beside it would have estimated, as a file of its own."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import UsageError
from bridge.loop.follower import FollowerSide
from bridge.loop.health import HealthSide, plain, watching
from bridge.machine.process import Stop
from bridge.recording.entries import Entries, Entry
from bridge.recording.reader import Recording, read
from bridge.recording.writer import entries_of, save
from bridge.replay.into_follower import through_follower
from bridge.scenario import changed
from bridge.wire.messages import ESTIMATE, HEALTH, INNOVATION, TOPICS
from twin.estimation.filter import Estimate
from twin.estimation.health import Rules
from twin.estimation.quantities import ESTIMATED, UNKNOWNS, Standing, Use
from twin.estimation.settings import Settings

MADE = (ESTIMATE, INNOVATION, HEALTH)


class Followed(NamedTuple):
    """How it went."""

    output: Path
    estimates: int
    restarts: int
    seconds: dict[str, float]  # by standing
    latest: Estimate
    health: HealthSide | None

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        last = self.latest
        return {
            "output": str(self.output),
            "estimates": self.estimates,
            "restarts": self.restarts,
            "seconds": self.seconds,
            "time": last.stamp,
            "health": None if self.health is None else plain(self.health.latest),
            "estimate": {n: _pair(ESTIMATED[n], last.values, last.deviations, n) for n in ESTIMATED},
            "unknowns": {n: _pair(UNKNOWNS[n].unit, last.unknowns, last.unknown_deviations, n) for n in last.unknowns},
            "channels": {
                name: {"use": Use(i.use).name.lower(), "nis": i.verdict.nis, "whiteness": i.verdict.whiteness}
                for name, i in last.innovations.items()
            },
        }


def _pair(unit: str, values: Mapping[str, float], deviations: Mapping[str, float], name: str) -> dict[str, Any]:
    return {"value": values[name], "deviation": deviations[name], "unit": unit}


def follow_recording(
    path: Path, output: Path, changes: Sequence[str], settings: Settings, rules: Rules | None = None
) -> Followed:
    """Follow a recording. Raises UsageError for one that cannot be followed, or an output that would replace it."""
    if output.resolve() == path.resolve():
        raise UsageError(f"{path}: would be overwritten; name another file with --output")
    recording = read(path)
    if "run" not in recording.metadata:
        raise UsageError(f"{recording.path}: the recording carries no scenario to follow it with")
    scenario = changed(recording.metadata["run"]["scenario"], changes, str(path))
    side = FollowerSide(scenario, settings if rules is None else watching(settings), rules=rules)
    entries, seconds = _made(recording, side)
    if side.latest is None:
        raise UsageError(f"{path}: no measurement in it to follow")
    kept = [entry for entry in recording.entries if entry.topic not in MADE and entry.topic in TOPICS]
    both = sorted([*kept, *entries], key=lambda entry: entry.log_time)
    counts = dict(Counter(entry.topic for entry in both))
    head = recording.metadata | {"followed": {"file": path.name, "changes": list(changes), "settings": repr(settings)}}
    save(recording._replace(entries=Entries(both), counts=counts, metadata=head), output, scenario.rig_name)
    return Followed(output, side.published[ESTIMATE], max(0, side.restarts), seconds, side.latest, side.health)


def _made(recording: Recording, side: FollowerSide) -> tuple[list[Entry], dict[str, float]]:
    """What the follower says, and how long it stood how. Raises UsageError when it is interrupted."""
    entries: list[Entry] = []
    seconds = {standing.name.lower(): 0.0 for standing in Standing if standing is not Standing.WAITING}
    stop, before = Stop(), 0
    try:
        listening = stop.listen()
        for messages in through_follower(recording, side):
            entries += entries_of(messages)
            for message in messages:
                if message.topic == ESTIMATE:
                    seconds[Standing(message.message.standing).name.lower()] += (message.log_time - before) / 1e9
                    before = message.log_time
            if listening():
                raise UsageError(f"interrupted at t = {side.now / 1e9:g} s; nothing is written")
    finally:
        stop.leave()
    return entries, seconds
