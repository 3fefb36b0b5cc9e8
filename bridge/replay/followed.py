"""`hydrotwin follow FILE`: a recording with what a twin beside it would have estimated, as a file of its own."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from bridge.errors import UsageError
from bridge.loop.follower import FollowerSide
from bridge.loop.health import HealthSide, plain, watching
from bridge.recording.entries import Entries, Entry
from bridge.recording.innovations import Missed, missed
from bridge.recording.made_before import is_replaced, save_whole
from bridge.recording.reader import Recording, read
from bridge.recording.verdicts import verdicts_of
from bridge.recording.writer import entries_of
from bridge.replay.into_follower import through_follower
from bridge.scenario import changed
from bridge.wire.messages import ESTIMATE, HEALTH, INNOVATION, TOPICS
from controller.grid import NS
from twin.estimation.filter import Estimate, Innovation
from twin.estimation.health import Rules
from twin.estimation.hypotheses import Verdict
from twin.estimation.quantities import ESTIMATED, UNKNOWNS, Standing, Use
from twin.estimation.settings import Settings
from twin.topology import CHANNELS

FACTS = "followed"  # record of facts about what was followed
LEFT_OUT = "left out"  # by --without
MADE = (ESTIMATE, INNOVATION, HEALTH)


class Followed(NamedTuple):
    """How it went."""

    output: Path
    replaced: bool  # a file that was made by following before
    estimates: int
    restarts: int
    seconds: dict[str, float]  # by standing
    latest: Estimate
    missed: dict[str, Missed]  # by channel
    without: tuple[str, ...]  # channels
    health: HealthSide | None
    judged: bool  # was there a verdict on its health?

    def plain(self) -> dict[str, Any]:
        """For JSON; NaN for what is not known."""
        last = self.latest
        return {
            "output": str(self.output),
            "replaced": self.replaced,
            "estimates": self.estimates,
            "restarts": self.restarts,
            "seconds": self.seconds,
            "time": last.stamp,
            "health": None if self.health is None else plain(self.health.latest) | {"judged": self.judged},
            "estimate": {n: _pair(ESTIMATED[n], last.values, last.deviations, n) for n in ESTIMATED},
            "unknowns": {n: _pair(UNKNOWNS[n].unit, last.unknowns, last.unknown_deviations, n) for n in last.unknowns},
            "channels": {name: self._channel(name, found) for name, found in last.innovations.items()},
        }

    def _channel(self, name: str, found: Innovation) -> dict[str, Any]:
        verdict, missed = found.verdict, self.missed[name]
        use = LEFT_OUT if name in self.without else Use(found.use).name.lower()
        own = {"use": use, "nis": verdict.nis, "whiteness": verdict.whiteness, "independent": verdict.square}
        return own | {"rms": missed.rms, "rms_in_deviations": missed.deviations, "unit": CHANNELS[name].unit}


def _pair(unit: str, values: Mapping[str, float], deviations: Mapping[str, float], name: str) -> dict[str, Any]:
    return {"value": values[name], "deviation": deviations[name], "unit": unit}


def follow_recording(
    path: Path, output: Path, changes: Sequence[str], settings: Settings, rules: Rules | None = None
) -> Followed:
    """Follow a recording. Raises UsageError for one that cannot be followed, or an output that must stay."""
    if output.resolve() == path.resolve():
        raise UsageError(f"{path}: would be overwritten; name another file with --output")
    replaced = is_replaced(output, FACTS, "follow")
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
    head = recording.metadata | {FACTS: {"file": path.name, "changes": list(changes), "settings": repr(settings)}}
    made = recording._replace(entries=Entries(both), counts=counts, metadata=head)
    save_whole(made, output, scenario.rig_name)
    return Followed(
        output,
        replaced,
        side.published[ESTIMATE],
        max(0, side.restarts),
        seconds,
        side.latest,
        missed(made),
        settings.without,
        side.health,
        any(said.verdict >= Verdict.HEALTHY for said in verdicts_of(made)),
    )


def _made(recording: Recording, side: FollowerSide) -> tuple[list[Entry], dict[str, float]]:
    """What the follower says, and how long it stood how."""
    entries: list[Entry] = []
    seconds = {standing.name.lower(): 0.0 for standing in Standing if standing is not Standing.WAITING}
    before = min((entry.log_time for entry in recording.of("measurement")), default=0)
    for messages in through_follower(recording, side):
        entries += entries_of(messages)
        for message in messages:
            if message.topic == ESTIMATE:
                seconds[Standing(message.message.standing).name.lower()] += (message.log_time - before) / NS
                before = message.log_time
    return entries, seconds
