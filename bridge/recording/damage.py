"""What is missing in a file, in numbers and in words."""

from typing import NamedTuple

from bridge.recording.scan import Scan, Span
from controller.grid import NS


class Damage(NamedTuple):
    """What could not be read; nothing of a sound file."""

    cut: bool = False  # the file has no end
    chunks: int = 0  # groups of messages that are damaged
    of: int = 0  # of so many
    spans: tuple[Span, ...] = ()  # of these, first and last log time [ns], as far as they are known
    records: int = 0  # that are damaged and not of messages: metadata, index
    nameless: int = 0  # messages of channels whose description is lost
    unreadable: int = 0  # messages that are not what their channel says

    @property
    def messages_missing(self) -> bool:
        """Are messages missing that had been recorded?"""
        return bool(self.cut or self.chunks or self.nameless or self.unreadable)

    @property
    def nothing(self) -> bool:
        """Is the file sound?"""
        return not (self.messages_missing or self.records)

    def words(self) -> list[str]:
        """Each in a sentence without its end; the cut is said elsewhere."""
        found = []
        if self.chunks:
            found.append(f"damaged: {self.chunks} of {self.of} chunks {_are(self.chunks)} left out{self._when()}")
        if self.records:
            found.append(f"damaged: {self.records} other records {_are(self.records)} left out: facts or index")
        if self.nameless:
            found.append(f"damaged: the channels of {self.nameless} messages are not described any more")
        if self.unreadable:
            found.append(f"damaged: {self.unreadable} messages are not what their channel says, and are left out")
        return found

    def _when(self) -> str:
        if not self.spans:
            return ""
        return ": " + ", ".join(f"t = {first / NS:g} s to {last / NS:g} s" for first, last in self.spans)


def damage(scan: Scan, nameless: int) -> Damage:
    """What a scan found."""
    lost = scan.chunks_lost
    return Damage(not scan.ended, lost, lost + scan.chunks, tuple(scan.spans()), scan.records_lost, nameless)


def _are(count: int) -> str:
    return "is" if count == 1 else "are"
