"""What a follower has said of the health of a rig, one verdict after the other."""

from typing import Any, NamedTuple

from bridge.recording.reader import Recording
from bridge.wire.health import PLACES
from bridge.wire.messages import HEALTH
from twin.estimation.hypotheses import HYPOTHESES, Verdict

NONE = -1  # `first` without a suspect


class Said(NamedTuple):
    """A verdict that is another than the one before."""

    stamp: int  # [ns]
    verdict: Verdict
    first: int  # the likeliest of PLACES, or NONE

    @property
    def words(self) -> str:
        """For people."""
        what = self.verdict.name.lower().replace("_", " ")
        return f"{what}: {HYPOTHESES[PLACES[self.first]].words}" if self.first != NONE else what


def verdicts_of(recording: Recording, before: Said | None = None) -> list[Said]:
    """In the order of their instants; before: what was said before the recording."""
    found: list[Said] = []
    if not recording.counts.get(HEALTH):
        return found
    columns: dict[str, Any] = recording.columns(HEALTH)
    for stamp, verdict, first in zip(columns["stamp"], columns["verdict"], columns["first"], strict=True):
        said = Said(int(stamp), Verdict(int(verdict)), int(first))
        if before is None or said[1:] != before[1:]:
            found.append(said)
        before = said
    return found
